/* L-BFGS on the objective of the problem with the Laplacian metric as initial inverse Hessian. The frames of the
   domain carry steps and gradients along: the recursion is the Euclidean one on every domain. */
#include "method/method.h"
#include "method/pairs.h"
#include "method/wolfe.h"

static const char *const line_searches[] = {"armijo", "wolfe", "EqmLbfgsLineSearch", "EQM_SEARCH_", NULL};

typedef struct {
  EqmMetric metric;
  EqmPairs pairs;
  PetscReal *image;
  EqmPlace trial;
  Vec gradient, trial_gradient, direction;
} Lbfgs;

PetscErrorCode EqmLbfgsRestart(EqmSolver solver)
{
  Lbfgs *const lb = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmPairsForget(lb->pairs));
  PetscCall(EqmMetricRefresh(solver, lb->metric));
  PetscCall(
      solver->problem->objective->evaluate(solver, &solver->place, solver->image, &solver->objective, lb->gradient));
  PetscCall(VecNorm(lb->gradient, NORM_2, &solver->gradient_norm));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmSolver solver)
{
  Lbfgs *lb;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lb));
  solver->data = lb;
  PetscCall(EqmMetricCreate(solver, &lb->metric));
  PetscCall(EqmPlaceCreate(solver->domain, &lb->trial));
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &lb->image));
  PetscCall(EqmDomainCreateVec(solver->domain, &lb->gradient));
  PetscCall(VecDuplicate(lb->gradient, &lb->trial_gradient));
  PetscCall(VecDuplicate(lb->gradient, &lb->direction));
  PetscCall(EqmPairsCreate(lb->gradient, solver->settings.lbfgs_memory, &lb->pairs));
  PetscCall(EqmLbfgsRestart(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Lbfgs *const lb = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricDestroy(&lb->metric));
  PetscCall(EqmPairsDestroy(&lb->pairs));
  PetscCall(EqmPlaceDestroy(&lb->trial));
  PetscCall(PetscFree(lb->image));
  PetscCall(VecDestroy(&lb->gradient));
  PetscCall(VecDestroy(&lb->trial_gradient));
  PetscCall(VecDestroy(&lb->direction));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* q <- M^-1 q on the scale of the inverse Hessian. */
static PetscErrorCode ApplyMetric(void *context, Vec q)
{
  const EqmSolver solver = context;
  Lbfgs *const lb = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricApply(solver, lb->metric, q, q));
  PetscCall(VecScale(q, solver->problem->objective->inverse_scale * solver->domain->target_measure));
  PetscFunctionReturn(0);
}

/* Armijo, with the parabola's minimum as the next guess; leaves the trial's map, energy and gradient. `t` 0: no
 * decrease. */
static PetscErrorCode Backtrack(EqmSolver solver, PetscReal slope, PetscReal *t, PetscReal *energy)
{
  Lbfgs *const lb = solver->data;
  enum { MOST_TRIALS = 25 };

  PetscFunctionBegin;
  *t = 1.;
  if (solver->problem->objective->longest_step)
    PetscCall(solver->problem->objective->longest_step(solver, lb->direction, t));
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscBool in_order;
    PetscCall(EqmDomainMove(solver->domain, &solver->place, *t, lb->direction, &lb->trial));
    PetscCall(EqmDomainBoundaryInOrder(solver->domain, &lb->trial, &in_order));
    PetscCall(solver->problem->objective->evaluate(solver, &lb->trial, lb->image, energy, lb->trial_gradient));
    const PetscReal change = *energy - solver->objective;
    if (in_order && change <= 1e-4 * *t * slope) PetscFunctionReturn(0);
    *t = in_order ? PetscMax(.1 * *t, PetscMin(.5 * *t, -.5 * *t * *t * slope / (change - *t * slope))) : .5 * *t;
  }
  *t = 0.;
  PetscFunctionReturn(0);
}

/* Frames go with the motion: the velocity keeps its coordinates along the whole geodesic. */
static PetscErrorCode TryStep(void *context, PetscReal t, PetscReal *value, PetscReal *slope)
{
  const EqmSolver solver = context;
  Lbfgs *const lb = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(solver->domain, &solver->place, t, lb->direction, &lb->trial));
  PetscCall(solver->problem->objective->evaluate(solver, &lb->trial, lb->image, value, lb->trial_gradient));
  PetscCall(VecDot(lb->trial_gradient, lb->direction, slope));
  PetscFunctionReturn(0);
}

/* The map changes less and less: a metric serves twice as long as the one before. */
static PetscBool IsRefreshDue(PetscInt first, PetscInt iteration)
{
  PetscInt due = first;

  while (due > 0 && due < iteration) due *= 2;
  return (PetscBool)(due > 0 && due == iteration);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Lbfgs *const lb = solver->data;
  PetscReal slope, t, energy;

  PetscFunctionBegin;
  if (!solver->problem->objective->fixed_metric && IsRefreshDue(solver->settings.lbfgs_refresh, solver->iteration))
    PetscCall(EqmMetricRefresh(solver, lb->metric));
  PetscCall(VecCopy(lb->gradient, lb->direction));
  PetscCall(EqmPairsDirection(lb->pairs, ApplyMetric, solver, lb->direction));
  PetscCall(VecScale(lb->direction, -1.));
  PetscCall(VecDot(lb->gradient, lb->direction, &slope));
  *outcome = EQM_STEP_STALLED;
  if (!(slope < 0.)) PetscFunctionReturn(0);
  if ((int)solver->settings.lbfgs_line_search == EQM_SEARCH_WOLFE)
    PetscCall(EqmWolfeSearch(TryStep, solver, solver->objective, slope, &t, &energy));
  else
    PetscCall(Backtrack(solver, slope, &t, &energy));
  if (t == 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsAdd(lb->pairs, t, lb->direction, lb->gradient, lb->trial_gradient));
  PetscCall(VecCopy(lb->trial_gradient, lb->gradient));
  PetscCall(EqmSolverAccept(solver, &lb->trial, lb->image, energy, t));
  PetscCall(VecNorm(lb->gradient, NORM_2, &solver->gradient_norm));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Lbfgs *const lb = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricState(solver, lb->metric, state));
  PetscCall(EqmPairsStateDofs(lb->pairs, state, solver->domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode Options(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt(
      "-lbfgs_refresh",
      "lbfgs: renew the metric after so many iterations, then each time after twice as many; 0: never",
      "EqmSolverSetFromOptions", set->lbfgs_refresh, &set->lbfgs_refresh, NULL, 0));
  PetscCall(PetscOptionsBoundedInt("-lbfgs_memory", "lbfgs: how many steps are remembered", "EqmSolverSetFromOptions",
                                   set->lbfgs_memory, &set->lbfgs_memory, NULL, 1));
  PetscCall(PetscOptionsEnum("-lbfgs_line_search", "lbfgs: when a step is long enough", "EqmSolverSetFromOptions",
                             line_searches, set->lbfgs_line_search, &set->lbfgs_line_search, NULL));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodLbfgs = {
    .name = "lbfgs",
    .purpose = "limited-memory quasi-Newton steps in the Laplacian metric: scalar factorisations only",
    .options = Options,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
