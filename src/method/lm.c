/* Levenberg-Marquardt on log ratios with geodesic acceleration (docs/methods.md).

   Minimise sum w rho^2 + (1/T) (the problem's added terms): rho a residual of each cell's ratio (problem/residual.h), T
   the target's measure. As rho is about r - 1 near the minimum, the first sum is about E/T there, so that terms have
   the same weight as beside E. On the sphere a term of the method's own, whose weight fades, keeps triangles upright.

   One iteration: the coupled Gauss-Newton matrix plus mu M, where M is an elastic metric weighted by the present
   residual (stiff where the map is wrong, loose where it is right), is factored once and solved three times: for the
   step, for the mean's rank-one term, for the second-order correction of the path. Then the factor serves as the
   initial inverse Hessian of quasi-Newton steps for as long as these pay. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include <math.h>
#include <string.h>

enum { MOST_DAMPINGS = 8, MEMORY = 10 };
/* Weighted by the residual, the metric vanishes with it; with less damping than this its near-null directions would
   carry rounding errors only. */
static const PetscReal least_damping = 1e-2;

/* Damping follows the length of the step that the search settled on; on the sphere and by cycles in larger strides.
   Factors by trial. */
static void AdaptDamping(EqmLm *lm, PetscReal t)
{
  const PetscBool sphere = (PetscBool)(lm->upright != NULL);

  if (t >= .99)
    lm->mu *= lm->by_cycles ? .2 : sphere ? .3 : .5;
  else if (t > .3)
    lm->mu *= sphere ? 2. : 1.;
  else if (t >= .13)
    lm->mu *= 10.;
  else
    lm->mu *= 31.6;
  lm->mu = PetscMax(lm->mu, least_damping);
  if (t < .99) lm->image_uses = 0; /* the map is not where the model said: coarse motions anew */
}

/* The weight of the upright term. */
static void SetKappa(EqmLm *lm, PetscReal kappa)
{
  lm->kappa = kappa;
  if (lm->upright) lm->upright->weight = kappa / lm->term_scale;
}

/* Sphere: the weight of the upright term falls when the term is a large part of the objective and not needed to keep
   steps long, or when the residual is in balance with it: a minimum of the sum is not yet one of the residual. */
static PetscErrorCode AdaptUpright(EqmMethod method, PetscReal t, PetscReal old_squares)
{
  EqmLm *const lm = method->data;
  PetscReal kappa = lm->kappa, part = 0.;

  PetscFunctionBegin;
  PetscCall(lm->upright->add(lm->upright, method->problem, &lm->now.place, lm->now.image, &part, NULL));
  part *= lm->term_scale / kappa;
  while (t > .2 && kappa * part > .1 * lm->now.squares && kappa > PETSC_MACHINE_EPSILON * PETSC_MACHINE_EPSILON)
    kappa *= .3;
  if (lm->now.squares > .97 * old_squares) kappa *= .01;
  SetKappa(lm, kappa);
  PetscCall(EqmLmAddTerms(method, &lm->now));
  PetscFunctionReturn(0);
}

/* Is a decrease that the model promises rounding only? Not where damping keeps steps short, nor on the sphere, where a
   minimum of the sum with the upright term is not yet one of the residual. */
static PetscBool IsRounding(const EqmLm *lm, PetscReal predicted, PetscReal level)
{
  if (lm->residual->without_mean && (lm->upright || lm->mu > 1.)) return PETSC_FALSE;
  return (PetscBool)(predicted <= level * lm->now.objective);
}

/* Steps with ever more damping until one decreases the objective; `t`: its length, 0: none does. */
static PetscErrorCode TryDampings(EqmMethod method, PetscReal *t, PetscBool *at_rest, PetscBool *converged)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  *t = 0.;
  *converged = PETSC_FALSE;
  for (PetscInt damping = 0; damping < MOST_DAMPINGS && *t == 0.; damping++) {
    PetscBool success;
    PetscReal ratio, predicted;
    PetscCall(EqmLmFactor(method, &success));
    if (success) PetscCall(EqmLmSolveForStep(method, &success));
    if (success) PetscCall(EqmLmSolveForCurve(method, &ratio, &success));
    if (success) {
      PetscCall(EqmLmPredictedDecrease(method, &predicted));
      *converged = IsRounding(lm, predicted, 1e-12);
      if (*converged) PetscFunctionReturn(0);
      *at_rest = (PetscBool)(*at_rest || IsRounding(lm, predicted, 1e-8));
      PetscCall(EqmLmSearch(method, ratio, predicted, t));
    }
    if (*t == 0.) lm->mu = PetscMax(10. * lm->mu, 1e-16);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  EqmLm *const lm = method->data;
  const PetscReal old_squares = lm->now.squares, old_mu = lm->mu;
  PetscBool at_rest = PETSC_FALSE; /* close to a minimum: should no step decrease the objective, this is one */
  PetscBool converged;
  PetscReal t;

  PetscFunctionBegin;
  if (!lm->residual->without_mean) { /* the level follows the total area from one iteration to the next */
    lm->level = PetscLogReal(iterate->totals.total);
    PetscCall(EqmLmEvaluate(method, &lm->now));
  }
  PetscCall(EqmLmLinearise(method, iterate));
  PetscCall(TryDampings(method, &t, &at_rest, &converged));
  if (t == 0. && !converged && !at_rest && lm->by_cycles) {
    PetscCall(EqmLmFallBack(method));
    lm->mu = old_mu;
    PetscCall(TryDampings(method, &t, &at_rest, &converged));
  }
  *outcome = converged || at_rest ? EQM_STEP_CONVERGED : EQM_STEP_STALLED;
  if (t == 0.) PetscFunctionReturn(0);
  AdaptDamping(lm, t);
  EqmLmSwap(&lm->now, &lm->best);
  PetscCall(EqmLmInnerSteps(method, iterate));
  if (lm->kappa > 0.) PetscCall(AdaptUpright(method, t, old_squares));
  PetscCall(EqmIterateAccept(method->problem, iterate, &lm->now.place, lm->now.image, lm->now.objective, t));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* ---- life */

static PetscErrorCode TrialCreate(EqmMethod method, EqmTrial *trial)
{
  const PetscInt n = method->problem->mesh->num_local_cells;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(method->problem->domain, &trial->place));
  PetscCall(PetscMalloc2(n, &trial->image, n, &trial->residual));
  PetscFunctionReturn(0);
}

static PetscErrorCode TrialDestroy(EqmTrial *trial)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&trial->place));
  PetscCall(PetscFree2(trial->image, trial->residual));
  PetscFunctionReturn(0);
}

/* What is as long as the cells, the vertices or the degrees of freedom are many. */
static PetscErrorCode MakeRoom(EqmMethod method)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt dim = method->problem->domain->dim, num_cells = mesh->num_local_cells;

  PetscFunctionBegin;
  PetscCall(TrialCreate(method, &lm->now));
  PetscCall(TrialCreate(method, &lm->best));
  PetscCall(TrialCreate(method, &lm->attempt));
  PetscCall(PetscMalloc3(num_cells, &lm->rho_first, num_cells, &lm->rho_second, num_cells, &lm->slope));
  PetscCall(PetscMalloc3(dim * mesh->num_local, &lm->velocity, dim * mesh->num_local, &lm->acceleration,
                         dim * mesh->num_owned, &lm->ambient));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &lm->descent));
  PetscCall(VecDuplicate(lm->descent, &lm->mean));
  PetscCall(VecDuplicate(lm->descent, &lm->step));
  PetscCall(VecDuplicate(lm->descent, &lm->curve));
  PetscCall(VecDuplicate(lm->descent, &lm->move));
  PetscCall(VecDuplicate(lm->descent, &lm->solved_mean));
  PetscCall(VecDuplicate(lm->descent, &lm->old_descent));
  PetscCall(VecDuplicate(lm->descent, &lm->direction));
  PetscCall(VecDuplicate(lm->descent, &lm->part));
  PetscCall(EqmPairsCreate(lm->descent, MEMORY, &lm->pairs));
  PetscFunctionReturn(0);
}

/* The residual is a logarithm: it needs a map without folds. */
static PetscErrorCode TakeStart(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &lm->now.place));
  PetscCall(EqmLmEvaluate(method, &lm->now));
  if (!(lm->now.objective < INFINITY)) {
    EqmFail(method->comm, EQM_ERR_USAGE,
            "-method lm needs a start without folds, and this one has %" PetscInt64_FMT
            "; take another -start, or -method lbfgs, ncg or rgd, which go on from folds, or a better mesh",
            iterate->totals.folds);
  }
  iterate->objective = lm->now.objective;
  iterate->gradient_norm = -1.;
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;
  const EqmProblem problem = method->problem;

  PetscFunctionBegin;
  lm->term_scale = 1. / problem->domain->target_measure;
  PetscCall(EqmLmChooseSolver(method));
  lm->mu = lm->by_cycles ? .1 : 1.;
  PetscCall(EqmLmChooseResidual(method));
  lm->level = lm->residual->without_mean ? 0. : PetscLogReal(iterate->totals.total);
  SetKappa(lm, 0.);
  if (problem->domain->measure == EQM_MEASURE_AREA3) { /* flat triangles can tip over */
    PetscCall(EqmTermCreateUpright(problem, 1., &lm->upright));
    PetscCall(EqmProblemAddTerm(problem, lm->upright));
    SetKappa(lm, 1.);
  }
  PetscCall(EqmLmCreateLinear(method));
  PetscCall(MakeRoom(method));
  PetscCall(VecSet(lm->mean, 0.)); /* where the residual has no mean it stays so */
  PetscCall(TakeStart(method, iterate));
  PetscFunctionReturn(0);
}

/* The factor and the pairs do not outlive an iteration. The objective depends on the upright term's weight. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "damping", &lm->mu));
  PetscCall(EqmStateReal(state, "barrier_weight", &lm->kappa));
  PetscCall(EqmLmLinearState(method, state));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  SetKappa(lm, lm->kappa);
  PetscCall(EqmLmAddTerms(method, &lm->now));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmDestroyLinear(method));
  if (lm->upright) {
    PetscCall(EqmProblemRemoveTerm(method->problem, lm->upright));
    PetscCall(lm->upright->destroy(lm->upright));
    lm->upright = NULL;
  }
  PetscCall(TrialDestroy(&lm->now));
  PetscCall(TrialDestroy(&lm->best));
  PetscCall(TrialDestroy(&lm->attempt));
  PetscCall(PetscFree3(lm->rho_first, lm->rho_second, lm->slope));
  PetscCall(PetscFree3(lm->velocity, lm->acceleration, lm->ambient));
  PetscCall(VecDestroy(&lm->descent));
  PetscCall(VecDestroy(&lm->mean));
  PetscCall(VecDestroy(&lm->step));
  PetscCall(VecDestroy(&lm->curve));
  PetscCall(VecDestroy(&lm->move));
  PetscCall(VecDestroy(&lm->solved_mean));
  PetscCall(VecDestroy(&lm->old_descent));
  PetscCall(VecDestroy(&lm->direction));
  PetscCall(VecDestroy(&lm->part));
  PetscCall(EqmPairsDestroy(&lm->pairs));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateLm(EqmMethod method)
{
  EqmLm *lm;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lm));
  lm->most_inner = 100;
  method->data = lm;
  method->purpose = "Levenberg-Marquardt on log ratios with geodesic acceleration";
  method->takes_terms = method->needs_ratios = PETSC_TRUE;
  method->ops = (EqmMethodOps){
      .set_from_options = EqmLmSetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
