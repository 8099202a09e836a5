/* The default's first map to the sphere: the linear map, and where that is none to begin with, fixed-point steps and
   unfolding, or two hemispheres. */
#include "method/method.h"
#include <stdint.h>

enum { STEPS_BETWEEN = 5 };

typedef struct {
  EqmPlace place;
  PetscInt64 from, folds; /* before unfolding and after */
  PetscReal smallest;     /* image triangle */
} Candidate;

/* Unfold the present map; it is `best` from then on if it has fewer folds, or as many and is better resolved. The
   present map is left folded as it was. */
static PetscErrorCode Consider(EqmSolver solver, EqmPlace *raw, Candidate *best)
{
  PetscInt64 from, folds;
  PetscReal smallest;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, raw));
  PetscCall(EqmSphereUnfold(solver, &from, &folds));
  PetscCall(EqmSphereSmallestImage(solver, &smallest));
  if (folds < best->folds || (folds == best->folds && smallest > best->smallest)) {
    PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &best->place));
    best->from = from;
    best->folds = folds;
    best->smallest = smallest;
  }
  PetscCall(EqmPlaceCopy(solver->domain, raw, &solver->place));
  PetscFunctionReturn(0);
}

/* A map without folds whose triangles the arithmetic resolves: from one with limbs shrunk to points no method gets
   away. */
static PetscBool IsGood(const Candidate *map)
{
  return (PetscBool)(map->folds == 0 && map->smallest >= EqmSmallestImage);
}

/* Fixed-point steps enlarge what the linear map makes too small, and fold here and there; unfolding mends what is not
   too bad. Take as few steps as lead to a good map. Where none does, the linear map was lost to rounding; that by
   equal weights knows no limb so thin. */
PetscErrorCode EqmSphereGuarded(EqmSolver solver, PetscInt most_steps)
{
  Candidate best = {.folds = INT64_MAX};
  PetscReal *weights;
  EqmPlace raw;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(solver->domain, &raw));
  PetscCall(EqmPlaceCreate(solver->domain, &best.place));
  PetscCall(EqmSphereLinear(solver, PETSC_FALSE));
  PetscCall(Consider(solver, &raw, &best));
  for (PetscInt k = 0; k < most_steps && !IsGood(&best); k++) {
    PetscCall(EqmSphereFixedPointStep(solver, k, weights));
    if ((k + 1) % STEPS_BETWEEN == 0) PetscCall(Consider(solver, &raw, &best));
  }
  if (!IsGood(&best)) {
    PetscCall(EqmSphereTutte(solver));
    PetscCall(Consider(solver, &raw, &best));
  }
  PetscCall(EqmPlaceCopy(solver->domain, &best.place, &solver->place));
  solver->unfolded_from = best.from;
  solver->unfolded_to = best.folds;
  PetscCall(EqmPlaceDestroy(&raw));
  PetscCall(EqmPlaceDestroy(&best.place));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}
