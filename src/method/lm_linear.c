/* What solves with lm's matrices: a factor, or cycles on a hierarchy of coarser meshes (-linear_solver hierarchy),
   which are told the map that coarse motions are interpolated in, and give way to a factor where they lead nowhere. */
#include "method/lm.h"
#include "problem/levels.h"

/* Steps by iteration end there, in the energy norm, which is the model's: smaller errors gain nothing. A cycle costs a
   tenth of its set-up and solves for one step only, so that a tenth is enough. */
static const PetscReal inexact = 1e-2, inexact_by_cycles = .1;
/* Matrices in a row whose coarse motions are interpolated in the same map: more take more cycles, fewer more set-ups.
 */
enum { MOST_USES = 4 };

/* Quasi-Newton steps towards one of the many maps with equal areas make up for a factor in single precision. Where the
   map is unique, as beside the angle energy, or where there are none of these steps, digits of the factor are digits of
   the map. */
static EqmMatrixUse FactorUse(const EqmLm *lm)
{
  return lm->most_inner > 0 && lm->residual->without_mean ? EQM_MATRIX_STEP : EQM_MATRIX_COUPLED;
}

static PetscErrorCode CreateFactor(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  lm->by_cycles = PETSC_FALSE;
  PetscCall(EqmProblemCreateLinear(method->problem, FactorUse(lm), &lm->linear));
  PetscCall(EqmLinearSetInexact(lm->linear, inexact));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmChooseSolver(EqmMethod method)
{
  EqmLm *const lm = method->data;
  const char *const obstacle = EqmLevelsObstacleToLinear(method->problem);
  EqmSolverKind kind;

  PetscFunctionBegin;
  PetscCall(EqmLinearWantedKind(&kind));
  lm->by_cycles = (PetscBool)(kind == EQM_SOLVER_HIERARCHY);
  if (lm->by_cycles && obstacle)
    EqmFail(method->comm, EQM_ERR_USAGE, "-linear_solver hierarchy %s; leave -linear_solver to the program", obstacle);
  lm->image_uses = 0;
  lm->cycles_failed = PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmCreateLinear(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  if (lm->by_cycles) {
    PetscCall(EqmProblemCreateLinearOnLevels(method->problem, &lm->linear));
    PetscCall(EqmLinearSetInexact(lm->linear, inexact_by_cycles));
  } else {
    PetscCall(CreateFactor(method));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmDestroyLinear(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLinearDestroy(&lm->linear));
  if (lm->image_of.x) PetscCall(EqmPlaceDestroy(&lm->image_of));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmPrepareLinear(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmSetFields(method));
  if (!lm->by_cycles) PetscFunctionReturn(0);
  if (!lm->image_of.x) PetscCall(EqmPlaceCreate(method->problem->domain, &lm->image_of));
  if (lm->image_uses % MOST_USES == 0) {
    lm->image_uses = 0;
    PetscCall(EqmPlaceCopy(method->problem->domain, &lm->now.place, &lm->image_of));
    PetscCall(EqmProblemSetImage(method->problem, &lm->image_of, lm->linear));
  }
  lm->image_uses++;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmFallBack(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(
      EqmProblemNotify(method->problem, "cycles on the hierarchy lead to no smaller objective; factors instead\n"));
  PetscCall(EqmLmDestroyLinear(method));
  PetscCall(CreateFactor(method));
  lm->cycles_failed = PETSC_TRUE;
  lm->image_uses = 0;
  PetscFunctionReturn(0);
}

/* Prolongations belong to an earlier map, which is kept. */
PetscErrorCode EqmLmLinearState(EqmMethod method, EqmState state)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmStateBool(state, "cycles_failed", &lm->cycles_failed));
  PetscCall(EqmStateInt(state, "image_uses", &lm->image_uses));
  if (lm->image_uses > 0) {
    if (!lm->image_of.x) PetscCall(EqmPlaceCreate(method->problem->domain, &lm->image_of));
    PetscCall(EqmStatePlace(state, method->problem->domain, "image_of", &lm->image_of));
  }
  if (!EqmStateIsLoading(state) || !lm->by_cycles) PetscFunctionReturn(0);
  if (lm->cycles_failed)
    PetscCall(EqmLmFallBack(method));
  else if (lm->image_uses > 0)
    PetscCall(EqmProblemSetImage(method->problem, &lm->image_of, lm->linear));
  PetscFunctionReturn(0);
}
