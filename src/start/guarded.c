/* The default's first map to the sphere: the linear map, and where that is none to begin with, fixed-point steps and
   unfolding, or two hemispheres. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "unfold/unfold.h"
#include "base/quiet.h"
#include <stdint.h>

enum { STEPS_BETWEEN = 5 };

typedef struct {
  EqmPlace place;
  PetscInt64 from, folds; /* before unfolding and after */
  PetscReal smallest;     /* image triangle */
} Candidate;

/* Unfold the present map; it is `best` from then on if it has fewer folds, or as many and is better resolved. The
   present map is left folded as it was. */
static PetscErrorCode Consider(EqmProblem problem, EqmIterate iterate, EqmPlace *raw, Candidate *best)
{
  PetscInt64 from, folds;
  PetscReal smallest;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, raw));
  PetscCall(EqmSphereUnfold(problem, iterate, &from, &folds));
  PetscCall(EqmSphereSmallestImage(problem, &iterate->place, &smallest));
  if (folds < best->folds || (folds == best->folds && smallest > best->smallest)) {
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best->place));
    best->from = from;
    best->folds = folds;
    best->smallest = smallest;
  }
  PetscCall(EqmPlaceCopy(problem->domain, raw, &iterate->place));
  PetscFunctionReturn(0);
}

/* A map without folds whose triangles the arithmetic resolves: from one with limbs shrunk to points no method gets
   away. */
static PetscBool IsGood(const Candidate *map)
{
  return (PetscBool)(map->folds == 0 && map->smallest >= EqmSmallestImage);
}

/* Where a triangle's image has vanished in rounding, the step's matrix is singular: another start is wanted then, not
   an error. */
static PetscErrorCode TryStep(EqmProblem problem, EqmIterate iterate, PetscInt step, PetscReal *weights,
                              PetscBool *success)
{
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmSphereFixedPointStep(problem, iterate, step, weights);
  PetscCall(PetscPopErrorHandler());
  PetscCheck(!error || error == EQM_ERR_MESH, problem->comm, error, "a fixed-point step of the start failed: %s",
             message);
  *success = (PetscBool)!error;
  PetscFunctionReturn(0);
}

/* Fixed-point steps enlarge what the linear map makes too small, and fold here and there; unfolding mends what is not
   too bad. Take as few steps as lead to a good map. Where none does, the linear map was lost to rounding; that by
   equal weights knows no limb so thin. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  Candidate best = {.folds = INT64_MAX};
  PetscReal *weights;
  PetscBool success;
  EqmPlace raw;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(problem->domain, &raw));
  PetscCall(EqmPlaceCreate(problem->domain, &best.place));
  PetscCall(EqmSphereLinear(problem, iterate, PETSC_FALSE));
  PetscCall(Consider(problem, iterate, &raw, &best));
  for (PetscInt k = 0; k < options->steps && !IsGood(&best); k++) {
    PetscCall(TryStep(problem, iterate, k, weights, &success));
    if (!success) break;
    if ((k + 1) % STEPS_BETWEEN == 0) PetscCall(Consider(problem, iterate, &raw, &best));
  }
  if (!IsGood(&best)) {
    PetscCall(EqmSphereTutte(problem, iterate));
    PetscCall(Consider(problem, iterate, &raw, &best));
  }
  PetscCall(EqmPlaceCopy(problem->domain, &best.place, &iterate->place));
  iterate->unfolded_from = best.from;
  iterate->unfolded_to = best.folds;
  PetscCall(EqmPlaceDestroy(&raw));
  PetscCall(EqmPlaceDestroy(&best.place));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereGuarded = {
    EQM_STARTS_SPHERE, "guarded",
    "linear; where it folds or shrinks limbs to points, fixed-point steps and unfolding, or tutte", 15, Run};
