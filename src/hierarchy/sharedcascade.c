/* The cascade on shared levels. */
#include "hierarchy/sharedcascade.h"
#include "hierarchy/sharedrelaxation.h"
#include "base/rows.h"
#include <math.h>

static PetscErrorCode Show(const EqmSharedLevel *shared, EqmLevelMap *map, const char *what, PetscInt count,
                           const EqmCascadeOptions *options)
{
  EqmLevelValue value;

  PetscFunctionBegin;
  if (!options->trace) PetscFunctionReturn(0);
  PetscCall(EqmSharedEvaluate(shared, map, map->x, &value));
  PetscCall(PetscPrintf(shared->comm,
                        "  %8" PetscInt_FMT " vertices, %-12s %5" PetscInt_FMT
                        ": energy %.3e, objective %.3e, folds %" PetscInt_FMT "\n",
                        shared->num_vertices, what, count, (double)value.energy, (double)value.objective, value.folds));
  PetscFunctionReturn(0);
}

/* Level k, whose map has come back from the next coarser one. */
static PetscErrorCode RelaxLevel(EqmShared shared, PetscInt k, EqmCascadeTarget target,
                                 const EqmCascadeOptions *options, EqmLevelMap *map)
{
  EqmSharedRelaxation relaxation;
  EqmLevelValue before;

  PetscFunctionBegin;
  PetscCall(EqmSharedRelaxationCreate(shared, k, target, map, &relaxation));
  PetscCall(EqmSharedRelaxationRun(relaxation, options, &before));
  PetscCall(EqmSharedRelaxationDestroy(&relaxation));
  PetscCall(Show(&shared->level[k], map, "relaxed", 0, options));
  PetscFunctionReturn(0);
}

/* The coarsest shared level, which is the finest of the first rank's own. Collective. */
static PetscErrorCode MapCoarsest(EqmShared shared, EqmLevelMap *map, EqmCascadeTarget target,
                                  EqmCascadeOptions *options)
{
  const EqmSharedLevel *const last = &shared->level[shared->num_levels - 1];
  EqmCascadeOptions below = *options;
  EqmCascadeResult result;
  PetscReal *x;

  PetscFunctionBegin;
  if (shared->num_levels > 1) below.epsilon_finest = options->epsilon;
  PetscCall(PetscMalloc1(map->dim * shared->coarser->level[0].num_vertices, &x));
  PetscCall(EqmHierarchyGather(shared->coarser, map->dim, map->x, x));
  PetscCall(EqmCascade(shared->coarser, target, &below, x, &result));
  PetscCall(EqmHierarchyScatter(shared->coarser, map->dim, x, map->x));
  PetscCall(PetscFree(x));
  PetscCall(EqmSharedUpdateGhosts(last, map->dim, map->x));
  options->epsilon = result.epsilon; /* no more than it was */
  options->epsilon_finest = PetscMin(options->epsilon_finest, result.epsilon);
  map->epsilon = PetscMin(below.epsilon_finest, result.epsilon);
  PetscCall(Show(last, map, "coarsest", 0, options));
  PetscFunctionReturn(0);
}

/* The finest level's map goes to x. */
static PetscErrorCode TakeFinest(EqmShared shared, EqmLevelMap *map, PetscReal *x, EqmCascadeResult *result)
{
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(EqmSharedEvaluate(&shared->level[0], map, map->x, &value));
  result->folds = value.folds;
  result->energy = value.energy;
  result->objective = value.objective;
  PetscCall(EqmRowsToRoots(shared->level[0].from_finer, map->dim, map->x, x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedCascade(EqmShared shared, EqmCascadeTarget target, const EqmCascadeOptions *options,
                                PetscReal *x, EqmCascadeResult *result)
{
  const PetscInt last = shared->num_levels - 1;
  EqmCascadeOptions weighted = *options;
  EqmLevelMap map[EQM_MOST_LEVELS];

  PetscFunctionBegin;
  for (PetscInt k = 0; k <= last; k++)
    PetscCall(EqmSharedMapCreate(&shared->level[k], target, k > 0 ? map[k - 1].x : x, &map[k]));
  PetscCall(MapCoarsest(shared, &map[last], target, &weighted));
  for (PetscInt k = last - 1; k >= 0; k--) {
    PetscInt hard;
    PetscCall(EqmSharedReinsert(&shared->level[k + 1], &map[k + 1], &shared->level[k], &map[k], &hard));
    PetscCall(EqmLevelMapDestroy(&map[k + 1]));
    map[k].epsilon = k == 0 ? weighted.epsilon_finest : weighted.epsilon;
    PetscCall(Show(&shared->level[k], &map[k], "reinserted", hard, options));
    PetscCall(RelaxLevel(shared, k, target, options, &map[k]));
  }
  result->before = INFINITY;
  result->epsilon = weighted.epsilon;
  PetscCall(TakeFinest(shared, &map[0], x, result));
  PetscCall(EqmLevelMapDestroy(&map[0]));
  PetscFunctionReturn(0);
}
