#include "hierarchy/relaxer.h"
#include "hierarchy/sharedrelaxation.h"
#include "base/rows.h"

struct _p_EqmRelaxer {
  EqmHierarchy hierarchy;
  EqmShared shared;
  EqmCascadeTarget target;
  EqmLevelMap map; /* of the finest shared level */
  EqmSharedRelaxation relaxation;
};

PetscErrorCode EqmRelaxerCreate(EqmHierarchy hierarchy, EqmShared shared, EqmCascadeTarget target, EqmRelaxer *relaxer)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(relaxer));
  (*relaxer)->hierarchy = hierarchy;
  (*relaxer)->shared = shared;
  (*relaxer)->target = target;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRelaxerDestroy(EqmRelaxer *relaxer)
{
  PetscFunctionBegin;
  if (!*relaxer) PetscFunctionReturn(0);
  PetscCall(EqmSharedRelaxationDestroy(&(*relaxer)->relaxation));
  PetscCall(EqmLevelMapDestroy(&(*relaxer)->map));
  PetscCall(PetscFree(*relaxer));
  PetscFunctionReturn(0);
}

/* The finest shared level's places are x; vertices move as they did in the first map. Collective. */
static PetscErrorCode TakePlaces(EqmRelaxer relaxer, const PetscReal *x)
{
  const EqmSharedLevel *const finest = &relaxer->shared->level[0];
  EqmLevelMap *const map = &relaxer->map;

  PetscFunctionBegin;
  if (!relaxer->relaxation) {
    PetscCall(EqmSharedMapCreate(finest, relaxer->target, x, map));
    PetscCall(EqmSharedRelaxationCreate(relaxer->shared, 0, relaxer->target, map, &relaxer->relaxation));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmRowsToLeaves(finest->from_finer, map->dim, x, map->x));
  PetscCall(EqmSharedUpdateGhosts(finest, map->dim, map->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRelaxerSetImage(EqmRelaxer relaxer, const EqmCascadeOptions *options, const PetscReal *x)
{
  PetscFunctionBegin;
  if (!relaxer->shared) PetscFunctionReturn(0);
  PetscCall(TakePlaces(relaxer, x));
  PetscCall(EqmSharedRelaxationSetImage(relaxer->relaxation, options->bottom));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunShared(EqmRelaxer relaxer, const EqmCascadeOptions *options, PetscReal *x,
                                EqmCascadeResult *result)
{
  const EqmSharedLevel *const finest = &relaxer->shared->level[0];
  EqmLevelMap *const map = &relaxer->map;
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(TakePlaces(relaxer, x));
  map->epsilon = result->epsilon = options->epsilon_finest;
  PetscCall(EqmSharedRelaxationRun(relaxer->relaxation, options, &value));
  result->before = value.objective;
  PetscCall(EqmSharedEvaluate(finest, map, map->x, &value));
  result->folds = value.folds;
  result->energy = value.energy;
  result->objective = value.objective;
  PetscCall(EqmRowsToRoots(finest->from_finer, map->dim, map->x, x));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunOnFirst(EqmRelaxer relaxer, const EqmCascadeOptions *options, PetscReal *x,
                                 EqmCascadeResult *result)
{
  const EqmHierarchy hierarchy = relaxer->hierarchy;
  const PetscInt dim = relaxer->target == EQM_TARGET_SPHERE ? 3 : 2;
  PetscReal *finest;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(dim * hierarchy->level[0].num_vertices, &finest));
  PetscCall(EqmHierarchyGather(hierarchy, dim, x, finest));
  PetscCall(EqmCascadeRelax(hierarchy, relaxer->target, options, finest, result));
  PetscCall(EqmHierarchyScatter(hierarchy, dim, finest, x));
  PetscCall(PetscFree(finest));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRelaxerRun(EqmRelaxer relaxer, const EqmCascadeOptions *options, PetscReal *x,
                             EqmCascadeResult *result)
{
  PetscFunctionBegin;
  PetscCall((relaxer->shared ? RunShared : RunOnFirst)(relaxer, options, x, result));
  PetscFunctionReturn(0);
}
