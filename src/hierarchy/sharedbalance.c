/* Gauss-Newton steps on a shared level. */
#include "hierarchy/sharedbalance.h"

static PetscErrorCode Evaluate(void *context, EqmLevelMap *map, const PetscReal *x, EqmLevelValue *value)
{
  PetscFunctionBegin;
  PetscCall(EqmSharedEvaluate(context, map, x, value));
  PetscFunctionReturn(0);
}

/* All ranks go on where all can. */
static PetscErrorCode OnAll(MPI_Comm comm, PetscBool *success)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedBalance(EqmShared shared, PetscInt k, EqmCascadeTarget target, PetscInt direct,
                                const EqmBalanceOptions *options, EqmLevelMap *map, PetscInt *iterations)
{
  EqmSharedLevel *const level = &shared->level[k];
  PetscReal damping = options->damping;
  EqmSharedCycle cycle = NULL;
  EqmLevelSystem system;
  EqmLevelValue value;

  PetscFunctionBegin;
  *iterations = 0;
  PetscCall(EqmSharedEvaluate(level, map, map->x, &value));
  PetscCall(EqmBalanceSystemCreate(map, &system));
  for (PetscInt s = 0; s < options->most_steps && value.folds == 0; s++) {
    const PetscReal before = value.objective;
    PetscReal t = 0.;
    PetscInt count = 0;
    PetscBool success;
    PetscCall(EqmBalanceAssemble(map, damping, value.residual, &system, &success));
    PetscCall(OnAll(level->comm, &success));
    if (success) {
      if (!cycle) PetscCall(EqmSharedCycleCreate(shared, k, target, map, direct, &system, &cycle));
      PetscCall(EqmSharedCycleFill(cycle, &success));
    }
    if (success) PetscCall(EqmSharedCycleSolve(cycle, options->tolerance, &count, &success));
    if (success) PetscCall(EqmBalanceSearch(map, system.solution, Evaluate, level, &value, &t));
    *iterations += count;
    damping = EqmBalanceNextDamping(damping, t);
    if (t >= .99 && before - value.objective < options->gain * before) break;
  }
  PetscCall(EqmSharedCycleDestroy(&cycle));
  PetscCall(EqmLevelSystemDestroy(&system));
  PetscFunctionReturn(0);
}
