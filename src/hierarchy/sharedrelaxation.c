#include "hierarchy/sharedrelaxation.h"

struct _p_EqmSharedRelaxation {
  EqmShared shared;
  PetscInt k;
  const EqmSharedLevel *level;
  EqmCascadeTarget target;
  EqmLevelMap *map;
  EqmSharedStars stars;
  EqmLevelSystem system;
  PetscBool has_system; /* made at the first step */
  EqmSharedCycle cycle; /* or NULL: none yet */
};

PetscErrorCode EqmSharedRelaxationCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target, EqmLevelMap *map,
                                         EqmSharedRelaxation *out)
{
  EqmSharedRelaxation relaxation;

  PetscFunctionBegin;
  PetscCall(PetscNew(&relaxation));
  relaxation->shared = shared;
  relaxation->k = k;
  relaxation->level = &shared->level[k];
  relaxation->target = target;
  relaxation->map = map;
  PetscCall(EqmLevelMapKeepAngles(map));
  PetscCall(EqmSharedStarsCreate(relaxation->level, &relaxation->stars));
  *out = relaxation;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedRelaxationDestroy(EqmSharedRelaxation *out)
{
  EqmSharedRelaxation relaxation = *out;

  PetscFunctionBegin;
  if (!relaxation) PetscFunctionReturn(0);
  PetscCall(EqmSharedCycleDestroy(&relaxation->cycle));
  if (relaxation->has_system) PetscCall(EqmLevelSystemDestroy(&relaxation->system));
  PetscCall(EqmSharedStarsDestroy(&relaxation->stars));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedRelaxationSetImage(EqmSharedRelaxation relaxation, PetscInt most)
{
  PetscFunctionBegin;
  if (!relaxation->has_system) PetscCall(EqmBalanceSystemCreate(relaxation->map, &relaxation->system));
  relaxation->has_system = PETSC_TRUE;
  PetscCall(EqmSharedCycleDestroy(&relaxation->cycle));
  PetscCall(EqmSharedCycleCreate(relaxation->shared, relaxation->k, relaxation->target, relaxation->map, most,
                                 &relaxation->system, &relaxation->cycle));
  PetscFunctionReturn(0);
}

static PetscErrorCode Evaluate(void *context, EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value)
{
  PetscFunctionBegin;
  PetscCall(EqmSharedEvaluate(context, map, x, value));
  PetscFunctionReturn(0);
}

/* A Gauss-Newton step; `t`: how much of it, 0: none. */
static PetscErrorCode Step(EqmSharedRelaxation relaxation, PetscReal damping, PetscReal tolerance, EqmLevelValue *value,
                           PetscReal *t)
{
  EqmLevelMap *const map = relaxation->map;
  PetscInt iterations;
  PetscBool success;

  PetscFunctionBegin;
  *t = 0.;
  PetscCall(EqmBalanceAssemble(map, damping, value->residual, &relaxation->system, &success));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &success, 1, MPIU_BOOL, MPI_LAND, relaxation->shared->comm));
  if (success) PetscCall(EqmSharedCycleFill(relaxation->cycle, &success));
  if (success) PetscCall(EqmSharedCycleSolve(relaxation->cycle, tolerance, &iterations, &success));
  if (success)
    PetscCall(EqmBalanceSearch(map, relaxation->system.solution, Evaluate, (void *)relaxation->level, value, t));
  PetscFunctionReturn(0);
}

static PetscErrorCode Steps(EqmSharedRelaxation relaxation, const EqmCascadeOptions *options, EqmLevelValue *value)
{
  /* a system solved to a tenth of the error gains hardly more, and takes twice as long */
  const PetscReal gain = 1e-2, tolerance = .3;
  PetscReal damping = .03, t;

  PetscFunctionBegin;
  if (!relaxation->cycle) PetscCall(EqmSharedRelaxationSetImage(relaxation, options->bottom));
  for (PetscInt s = 0; s < options->steps && value->folds == 0; s++) {
    const PetscReal before = value->objective;
    PetscCall(Step(relaxation, damping, tolerance, value, &t));
    damping = EqmBalanceNextDamping(damping, t);
    if (t >= .99 && before - value->objective < gain * before) break;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedRelaxationRun(EqmSharedRelaxation relaxation, const EqmCascadeOptions *options,
                                      EqmLevelValue *before)
{
  const EqmSharedLevel *const level = relaxation->level;
  EqmLevelMap *const map = relaxation->map;
  EqmLevelValue value;

  PetscFunctionBegin;
  PetscCall(EqmSharedEvaluate(level, map, map->x, before)); /* for its total, too */
  if (before->folds > 0) PetscFunctionReturn(0);
  value = *before;
  for (PetscInt s = 0; s < options->sweeps; s += 2) {
    const PetscReal last = value.objective;
    PetscCall(EqmSharedRelax(level, map, &relaxation->stars, PetscMin(2, options->sweeps - s)));
    PetscCall(EqmSharedEvaluate(level, map, map->x, &value));
    if (value.objective > (1. - options->least_gain) * last) break;
  }
  if (options->steps > 0 && value.objective <= (1. - options->least_gain) * before->objective)
    PetscCall(Steps(relaxation, options, &value));
  PetscCall(EqmSharedRelax(level, map, &relaxation->stars, EQM_SWEEPS_AFTER));
  PetscFunctionReturn(0);
}
