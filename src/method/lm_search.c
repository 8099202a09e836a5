/* The search along the curve, and the quasi-Newton steps that get more out of a factor. */
#include "method/lm.h"
#include <math.h>

enum { MOST_HALVINGS = 7, INNER_WINDOW = 5 };
/* A factorisation costs about as much as so many quasi-Newton steps. */
static const PetscReal factor_cost = 25.;

void EqmLmSwap(EqmTrial *a, EqmTrial *b)
{
  const EqmTrial t = *a;
  *a = *b;
  *b = t;
}

/* Evaluate the map at parameter t, with or without the second-order correction; keep it if it is the best so far. */
static PetscErrorCode TryAt(EqmMethod method, PetscReal t, PetscBool curved, PetscReal *best_t, PetscReal *objective)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(VecCopy(lm->step, lm->move));
  PetscCall(VecScale(lm->move, t));
  if (curved) PetscCall(VecAXPY(lm->move, t * t, lm->curve));
  PetscCall(EqmDomainMove(method->problem->domain, &lm->now.place, 1., lm->move, &lm->attempt.place));
  PetscCall(EqmLmEvaluate(method, &lm->attempt));
  *objective = lm->attempt.objective;
  if (lm->attempt.objective < (*best_t > 0. ? lm->best.objective : lm->now.objective)) {
    *best_t = t;
    EqmLmSwap(&lm->attempt, &lm->best);
  }
  PetscFunctionReturn(0);
}

/* Halve t until a trial is worse than the best or the decrease is a fair share of the prediction; `best_t` 0 if nothing
   decreases the objective. */
PetscErrorCode EqmLmSearch(EqmMethod method, PetscReal ratio, PetscReal predicted, PetscReal *best_t)
{
  EqmLm *const lm = method->data;
  const PetscBool is_log = lm->residual->without_mean;
  const PetscReal share = is_log ? .3 : .1;
  PetscReal t = ratio < 1. ? 1. : 1. / ratio, objective;

  PetscFunctionBegin;
  *best_t = 0.;
  for (PetscInt halving = 0; halving < MOST_HALVINGS; halving++, t *= .5) {
    PetscCall(TryAt(method, t, PETSC_TRUE, best_t, &objective));
    if (ratio >= 1. || halving >= 2 || !is_log) PetscCall(TryAt(method, t, PETSC_FALSE, best_t, &objective));
    if (*best_t > 0. &&
        (objective > lm->best.objective || lm->best.objective < lm->now.objective - share * t * predicted))
      break;
  }
  PetscFunctionReturn(0);
}

/* Armijo search along lm->direction from t on, leaving the map in lm->attempt; `t` is 0 if nothing decreases enough. */
static PetscErrorCode Backtrack(EqmMethod method, PetscReal slope, PetscReal *t)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  for (PetscInt trial = 0; trial < MOST_HALVINGS; trial++) {
    PetscCall(EqmDomainMove(method->problem->domain, &lm->now.place, *t, lm->direction, &lm->attempt.place));
    PetscCall(EqmLmEvaluate(method, &lm->attempt));
    const PetscReal change = lm->attempt.objective - lm->now.objective;
    if (change < 1e-4 * *t * slope) PetscFunctionReturn(0);
    if (!(change < INFINITY))
      *t *= .5; /* folds: no parabola */
    else
      *t = PetscMax(.1 * *t, PetscMin(.5 * *t, -.5 * *t * *t * slope / (change - *t * slope)));
  }
  *t = 0.;
  PetscFunctionReturn(0);
}

/* The decrease of log(objective) per step over the last few. */
static PetscReal RecentDecrease(PetscInt steps, const PetscReal *objective)
{
  const PetscInt window = PetscMin(steps, INNER_WINDOW);

  return PetscLogReal(objective[steps - window] / objective[steps]) / window;
}

/* Is another step on this factor worth less than a new factor? The marginal value theorem with costs in steps: leave
   when the recent decrease of log(objective) per step is below the average per cost since the factorisation. Not where
   the run would have the energy that it is to reach, E being about A sum w rho^2, before a new factor were there. */
static PetscBool IsUsedUp(PetscInt steps, const PetscReal *objective, PetscReal before, PetscReal excess)
{
  const PetscReal recent = RecentDecrease(steps, objective);

  if (steps < 3 || PetscLogReal(excess) < factor_cost * recent) return PETSC_FALSE;
  return (PetscBool)(recent < PetscLogReal(before / objective[steps]) / (factor_cost + steps));
}

/* How far the energy is above the one that the run is to reach: infinite where there is none. */
static PetscReal Excess(EqmMethod method, const EqmIterate iterate)
{
  const PetscReal close = .99;

  if (method->energy_target <= 0.) return INFINITY;
  return ((EqmLm *)method->data)->now.squares * iterate->totals.total / (close * method->energy_target);
}

/* Quasi-Newton steps (L-BFGS) with the present factor as the initial inverse Hessian: a solve is some twenty times
   cheaper than a factorisation. The frames of the domain carry gradients from one map to the next. Collective. */
PetscErrorCode EqmLmInnerSteps(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;
  const PetscInt most = lm->by_cycles ? 0 : lm->most_inner;
  PetscReal *objective, t = .25, slope, excess = Excess(method, iterate);

  PetscFunctionBegin;
  if (most == 0) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(most + 1, &objective));
  objective[0] = lm->now.objective;
  PetscCall(EqmPairsForget(lm->pairs));
  PetscCall(EqmLmGradient(method)); /* lm->mean stays the factor's */
  for (PetscInt k = 0; k < most && excess > 1. && (k == 0 || !IsUsedUp(k, objective, iterate->objective, excess));
       k++) {
    PetscCall(VecCopy(lm->descent, lm->direction));
    PetscCall(EqmPairsDirection(lm->pairs, EqmLmApplyInverse, method, lm->direction));
    PetscCall(VecDot(lm->descent, lm->direction, &slope));
    PetscCheck(PetscAbsReal(slope) <= PETSC_MAX_REAL, method->comm, PETSC_ERR_FP, "a direction of lm is not finite");
    t = PetscMin(1., 4. * t);
    if (slope > 0.) PetscCall(Backtrack(method, -2. * slope, &t));
    if (!(slope > 0.) || t == 0.) break;
    EqmLmSwap(&lm->now, &lm->attempt);
    PetscCall(VecCopy(lm->descent, lm->old_descent));
    PetscCall(EqmLmGradient(method));
    PetscCall(
        EqmPairsAdd(lm->pairs, t, lm->direction, lm->descent, lm->old_descent)); /* descent is minus the gradient */
    objective[k + 1] = lm->now.objective;
    excess = Excess(method, iterate);
  }
  PetscCall(EqmLmGradientNorm(method, &iterate->gradient_norm));
  PetscCall(PetscFree(objective));
  PetscFunctionReturn(0);
}
