/* The default's first map to the sphere: the linear map, and where that is none to begin with, fixed-point steps and
   unfolding, or two hemispheres; or the smoothed Gauss map, which suits bodies that are nearly convex. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include "unfold/unfold.h"
#include <stdint.h>

enum { STEPS_BETWEEN = 5, GAUSS_STEPS = 20 };

typedef struct {
  EqmPlace place;
  PetscInt64 from, folds; /* before unfolding and after */
  PetscReal smallest;     /* image triangle */
  PetscReal energy;
} Candidate;

/* A map without folds whose triangles the arithmetic resolves: from one with limbs shrunk to points no method gets
   away. */
static PetscBool IsGood(const Candidate *map)
{
  return (PetscBool)(map->folds == 0 && map->smallest >= EqmSmallestImage);
}

/* Of two good maps the one of lower energy; else fewer folds, or as many and better resolved. */
static PetscBool IsBetter(const Candidate *a, const Candidate *b)
{
  if (IsGood(a) && IsGood(b)) return (PetscBool)(a->energy < b->energy);
  return (PetscBool)(a->folds < b->folds || (a->folds == b->folds && a->smallest > b->smallest));
}

/* Unfold the present map; it is `best` from then on if it is the better one. The present map is left folded as it was.
 */
static PetscErrorCode Consider(EqmProblem problem, EqmIterate iterate, EqmPlace *raw, Candidate *best)
{
  Candidate now;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, raw));
  PetscCall(EqmSphereUnfold(problem, iterate, &now.from, &now.folds));
  PetscCall(EqmSphereSmallestImage(problem, &iterate->place, &now.smallest));
  PetscCall(EqmIterateUpdate(problem, iterate));
  now.energy = iterate->totals.energy;
  if (IsBetter(&now, best)) {
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best->place));
    now.place = best->place;
    *best = now;
  }
  PetscCall(EqmPlaceCopy(problem->domain, raw, &iterate->place));
  PetscFunctionReturn(0);
}

/* ---- candidates, each made in the iterate */
static PetscErrorCode MakeLinear(EqmProblem problem, EqmIterate iterate, PetscInt step, PetscReal *weights)
{
  (void)step, (void)weights;
  PetscFunctionBegin;
  PetscCall(EqmSphereLinear(problem, iterate, PETSC_FALSE));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakeTutte(EqmProblem problem, EqmIterate iterate, PetscInt step, PetscReal *weights)
{
  PetscBool found;

  (void)step, (void)weights;
  PetscFunctionBegin;
  PetscCall(EqmSphereTutte(problem, iterate, EQM_HEMISPHERE_UNIFORM, &found));
  PetscCheck(found, problem->comm, EQM_ERR_MESH, "no closed curve was found that cuts the surface in two disks");
  PetscFunctionReturn(0);
}

/* With folds the surface is none that this map suits. */
static PetscErrorCode MakeGauss(EqmProblem problem, EqmIterate iterate, PetscInt step, PetscReal *scratch)
{
  PetscInt64 folds;

  (void)step;
  PetscFunctionBegin;
  PetscCall(EqmSphereGauss(problem, iterate, GAUSS_STEPS));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, scratch, &folds));
  PetscCheck(folds == 0, problem->comm, EQM_ERR_MESH, "the smoothed normals fold");
  PetscFunctionReturn(0);
}

/* Make a candidate. That a solve breaks down, as with the weights of a map that folds, is no failure of the start: then
   `made` is false, and the iterate is any map. */
static PetscErrorCode Make(PetscErrorCode (*make)(EqmProblem, EqmIterate, PetscInt, PetscReal *), EqmProblem problem,
                           EqmIterate iterate, PetscInt step, PetscReal *weights, PetscBool *made)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = make(problem, iterate, step, weights);
  PetscCall(PetscPopErrorHandler());
  PetscCheck(!error || error == EQM_ERR_MESH, problem->comm, error, "%s", message);
  *made = (PetscBool)!error;
  PetscFunctionReturn(0);
}

/* Fixed-point steps enlarge what the linear map makes too small, and fold here and there; unfolding mends what is not
   too bad. Take as few steps as lead to a good map. Where none does, the linear map was lost to rounding; that by
   equal weights knows no limb so thin. */
static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  Candidate best = {.folds = INT64_MAX};
  PetscReal *weights;
  PetscBool made;
  EqmPlace raw;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(problem->domain, &raw));
  PetscCall(EqmPlaceCreate(problem->domain, &best.place));
  PetscCall(Make(MakeLinear, problem, iterate, 0, NULL, &made));
  if (made) PetscCall(Consider(problem, iterate, &raw, &best));
  for (PetscInt k = 0; made && k < options->steps && !IsGood(&best); k++) {
    PetscCall(Make(EqmSphereFixedPointStep, problem, iterate, k, weights, &made));
    if (made && (k + 1) % STEPS_BETWEEN == 0) PetscCall(Consider(problem, iterate, &raw, &best));
  }
  if (!IsGood(&best)) {
    PetscCall(Make(MakeTutte, problem, iterate, 0, NULL, &made));
    if (made) PetscCall(Consider(problem, iterate, &raw, &best));
  }
  PetscCall(Make(MakeGauss, problem, iterate, 0, weights, &made));
  if (made) PetscCall(Consider(problem, iterate, &raw, &best));
  if (best.folds == INT64_MAX)
    EqmFail(problem->comm, EQM_ERR_MESH, "no first map to the sphere: the mesh's cells are too degenerate; remesh");
  PetscCall(EqmPlaceCopy(problem->domain, &best.place, &iterate->place));
  iterate->unfolded_from = best.from;
  iterate->unfolded_to = best.folds;
  PetscCall(EqmPlaceDestroy(&raw));
  PetscCall(EqmPlaceDestroy(&best.place));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereGuarded = {EQM_STARTS_SPHERE, "guarded",
                                            "linear; where it folds or shrinks limbs to points, fixed-point steps and "
                                            "unfolding, or tutte; gauss if that is nearer "
                                            "to equal areas",
                                            15, Run};
