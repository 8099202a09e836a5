/* L-BFGS on the objective of the problem with the Laplacian metric as initial inverse Hessian. Degrees of freedom refer
   to frames that parallel transport carries along, so the two-loop recursion is the Euclidean one on every domain. */
#include "method/method.h"
#include "domain/domain_private.h"
#include "method/pairs.h"
#include "method/wolfe.h"

static const char *const line_searches[] = {"armijo", "wolfe", "EqmLbfgsLineSearch", "EQM_SEARCH_", NULL};

typedef struct {
  PetscInt refresh, memory;
  EqmLbfgsLineSearch line_search;
  EqmMetric metric;
  EqmPairs pairs;
  PetscReal *image;
  EqmPlace trial;
  Vec gradient, trial_gradient, direction;
} Lbfgs;

PetscErrorCode EqmLbfgsRestart(EqmMethod method, EqmIterate iterate)
{
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPairsForget(lb->pairs));
  PetscCall(EqmMetricRefresh(lb->metric, &iterate->place));
  PetscCall(
      EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective, lb->gradient));
  PetscCall(VecNorm(lb->gradient, NORM_2, &iterate->gradient_norm));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricCreate(method->problem, &lb->metric));
  if (lb->refresh < 0) lb->refresh = EqmMetricIsCycle(lb->metric) ? 20 : 10;
  PetscCall(EqmPlaceCreate(method->problem->domain, &lb->trial));
  PetscCall(PetscMalloc1(method->problem->mesh->num_local_cells, &lb->image));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &lb->gradient));
  PetscCall(VecDuplicate(lb->gradient, &lb->trial_gradient));
  PetscCall(VecDuplicate(lb->gradient, &lb->direction));
  PetscCall(EqmPairsCreate(lb->gradient, lb->memory, &lb->pairs));
  PetscCall(EqmLbfgsRestart(method, iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricDestroy(&lb->metric));
  PetscCall(EqmPairsDestroy(&lb->pairs));
  PetscCall(EqmPlaceDestroy(&lb->trial));
  PetscCall(PetscFree(lb->image));
  PetscCall(VecDestroy(&lb->gradient));
  PetscCall(VecDestroy(&lb->trial_gradient));
  PetscCall(VecDestroy(&lb->direction));
  PetscFunctionReturn(0);
}

/* q <- M^-1 q on the scale of the inverse Hessian. */
static PetscErrorCode ApplyMetric(void *context, Vec q)
{
  const EqmMethod method = context;
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricApply(lb->metric, &method->iterate->place, q, q));
  PetscCall(VecScale(q, method->problem->objective->inverse_scale * method->problem->domain->target_measure));
  PetscFunctionReturn(0);
}

/* Armijo, with the parabola's minimum as the next guess; leaves the trial's map, energy and gradient. `t` 0: no
   decrease. */
static PetscErrorCode Backtrack(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *t, PetscReal *energy)
{
  Lbfgs *const lb = method->data;
  enum { MOST_TRIALS = 25 };

  PetscFunctionBegin;
  *t = 1.;
  if (method->problem->objective->longest_step)
    PetscCall(method->problem->objective->longest_step(method->problem, iterate, lb->direction, t));
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscBool in_order;
    PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, *t, lb->direction, &lb->trial));
    PetscCall(EqmDomainBoundaryInOrder(method->problem->domain, &lb->trial, &in_order));
    PetscCall(EqmProblemEvaluate(method->problem, iterate, &lb->trial, lb->image, energy, lb->trial_gradient));
    const PetscReal change = *energy - iterate->objective;
    if (in_order && change <= 1e-4 * *t * slope) PetscFunctionReturn(0);
    *t = in_order ? PetscMax(.1 * *t, PetscMin(.5 * *t, -.5 * *t * *t * slope / (change - *t * slope))) : .5 * *t;
  }
  *t = 0.;
  PetscFunctionReturn(0);
}

/* Frames are transported with the motion: the velocity has the same coordinates along the whole geodesic. */
static PetscErrorCode TryStep(void *context, PetscReal t, PetscReal *value, PetscReal *slope)
{
  const EqmMethod method = context;
  const EqmIterate iterate = method->iterate;
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, t, lb->direction, &lb->trial));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &lb->trial, lb->image, value, lb->trial_gradient));
  PetscCall(VecDot(lb->trial_gradient, lb->direction, slope));
  PetscFunctionReturn(0);
}

/* The map changes less and less: each metric is used for twice as many iterations as the one before. */
static PetscBool IsRefreshDue(PetscInt first, PetscInt iteration)
{
  PetscInt due = first;

  while (due > 0 && due < iteration) due *= 2;
  return (PetscBool)(due > 0 && due == iteration);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Lbfgs *const lb = method->data;
  PetscReal slope, t, energy;

  PetscFunctionBegin;
  if (!method->problem->objective->fixed_metric && IsRefreshDue(lb->refresh, iterate->number))
    PetscCall(EqmMetricRefresh(lb->metric, &iterate->place));
  PetscCall(VecCopy(lb->gradient, lb->direction));
  PetscCall(EqmPairsDirection(lb->pairs, ApplyMetric, method, lb->direction));
  PetscCall(VecScale(lb->direction, -1.));
  PetscCall(VecDot(lb->gradient, lb->direction, &slope));
  *outcome = EQM_STEP_STALLED;
  if (!(slope < 0.)) PetscFunctionReturn(0);
  if (lb->line_search == EQM_SEARCH_WOLFE)
    PetscCall(EqmWolfeSearch(TryStep, method, iterate->objective, slope, EQM_WOLFE_FLATNESS, &t, &energy));
  else
    PetscCall(Backtrack(method, iterate, slope, &t, &energy));
  if (t == 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsAdd(lb->pairs, t, lb->direction, lb->gradient, lb->trial_gradient));
  PetscCall(VecCopy(lb->trial_gradient, lb->gradient));
  PetscCall(EqmIterateAccept(method->problem, iterate, &lb->trial, lb->image, energy, t));
  PetscCall(VecNorm(lb->gradient, NORM_2, &iterate->gradient_norm));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Lbfgs *const lb = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricState(lb->metric, state));
  PetscCall(EqmPairsStateDofs(lb->pairs, state, method->problem->domain));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  Lbfgs *const lb = method->data;
  PetscEnum search = (PetscEnum)lb->line_search;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt(
      "-lbfgs_refresh",
      "lbfgs: renew the metric after so many iterations, then each time after twice as many; 0: never, -1: 10, with "
      "multigrid 20",
      "EqmSolverSetFromOptions", lb->refresh, &lb->refresh, NULL, -1));
  PetscCall(PetscOptionsBoundedInt("-lbfgs_memory", "lbfgs: how many steps are remembered", "EqmSolverSetFromOptions",
                                   lb->memory, &lb->memory, NULL, 1));
  PetscCall(PetscOptionsEnum("-lbfgs_line_search", "lbfgs: when a step is long enough", "EqmSolverSetFromOptions",
                             line_searches, search, &search, NULL));
  lb->line_search = (EqmLbfgsLineSearch)search;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLbfgsSetMemory(EqmMethod method, PetscInt memory)
{
  PetscFunctionBegin;
  ((Lbfgs *)method->data)->memory = memory;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLbfgsSetLineSearch(EqmMethod method, EqmLbfgsLineSearch search)
{
  PetscFunctionBegin;
  ((Lbfgs *)method->data)->line_search = search;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateLbfgs(EqmMethod method)
{
  Lbfgs *lb;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lb));
  lb->refresh = -1;
  lb->memory = 10;
  method->data = lb;
  method->purpose = "limited-memory quasi-Newton steps in the Laplacian metric: scalar factorisations only";
  method->takes_terms = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
