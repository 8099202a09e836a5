/* Levenberg-Marquardt on log ratios with geodesic acceleration (docs/methods.md).

   Minimise sum w rho^2 + (eps/T) (E_D - A): rho a residual of each cell's ratio, T the target's measure, E_D - A the
   angle energy (E_D with the mesh's cotangents). With eps = 0, rho = log(a/w) less its weighted mean; with eps > 0, rho
   = r - 1 above one and log r below, r = (a/w)/A, which reaches the minimum straight from a Tutte map.

   One iteration: the coupled Gauss-Newton matrix plus mu M, where M is an elastic metric weighted by the present
   residual (stiff where the map is wrong, loose where it is right), is factored once and solved three times: for the
   step, for the mean's rank-one term, for the bend of the geodesic. Then the factor serves as the initial inverse
   Hessian of quasi-Newton steps for as long as these pay. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include <math.h>
#include <string.h>

enum { MOST_DAMPINGS = 8, MEMORY = 10 };
/* Weighted by the residual, the metric fades by itself; below this its near-null directions would carry rounding, not
 * news. */
static const PetscReal least_damping = 1e-2;
/* Of steps by iteration: in the energy norm, which is the model's. Smaller ones gain nothing. */
static const PetscReal inexact = 1e-2;

/* Damping follows the length of the step that the search settled on; on the sphere in larger strides. Factors by trial.
 */
static void AdaptDamping(EqmLm *lm, PetscReal t)
{
  const PetscBool sphere = (PetscBool)(lm->lean_rate != NULL);

  if (t >= .99)
    lm->mu *= sphere ? .3 : .5;
  else if (t > .3)
    lm->mu *= sphere ? 2. : 1.;
  else if (t >= .13)
    lm->mu *= 10.;
  else
    lm->mu *= 31.6;
  lm->mu = PetscMax(lm->mu, least_damping);
}

/* Sphere: the barrier gives way when it is a large part of the objective and not needed to keep steps long, or when it
   is what the residual is in balance with: a minimum of the sum is not yet one of the residual. */
static void AdaptBarrier(EqmMethod method, PetscReal t, PetscReal old_squares)
{
  EqmLm *const lm = method->data;

  while (t > .2 && lm->kappa * lm->now.barrier > .1 * lm->now.squares &&
         lm->kappa > PETSC_MACHINE_EPSILON * PETSC_MACHINE_EPSILON) {
    lm->kappa *= .3;
  }
  if (lm->now.squares > .97 * old_squares) lm->kappa *= .01;
  EqmLmWeigh(method, &lm->now);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  EqmLm *const lm = method->data;
  const PetscReal old_squares = lm->now.squares;
  PetscReal t = 0.;

  PetscFunctionBegin;
  if (lm->epsilon > 0.) { /* the level follows the total area from one iteration to the next */
    lm->level = PetscLogReal(iterate->totals.total);
    PetscCall(EqmLmEvaluate(method, &lm->now));
  }
  PetscCall(EqmLmLinearise(method, iterate));
  for (PetscInt damping = 0; damping < MOST_DAMPINGS && t == 0.; damping++) {
    PetscBool success;
    PetscReal ratio, predicted;
    PetscCall(EqmLmFactor(method, &success));
    if (success) PetscCall(EqmLmSolveForStep(method, &success));
    if (success) {
      PetscCall(EqmLmSolveForCurve(method, &ratio));
      PetscCall(EqmLmPredictedDecrease(method, &predicted));
      if (lm->epsilon > 0. && predicted <= 1e-12 * lm->now.objective) { /* what is left is rounding */
        *outcome = EQM_STEP_CONVERGED;
        PetscFunctionReturn(0);
      }
      PetscCall(EqmLmSearch(method, ratio, predicted, &t));
    }
    if (t == 0.) lm->mu = PetscMax(10. * lm->mu, 1e-16);
  }
  *outcome = EQM_STEP_STALLED;
  if (t == 0.) PetscFunctionReturn(0);
  AdaptDamping(lm, t);
  EqmLmSwap(&lm->now, &lm->best);
  PetscCall(EqmLmInnerSteps(method, iterate));
  if (lm->kappa > 0.) AdaptBarrier(method, t, old_squares);
  PetscCall(EqmIterateAccept(method->problem, iterate, &lm->now.place, lm->now.image, lm->now.objective, t));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* ---- life */

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt("-lm_inner",
                                   "lm: at most so many quasi-Newton steps on each factor; with 0 a map takes more "
                                   "factorisations, and hardly magnifies the rounding of the input",
                                   "EqmSolverSetFromOptions", lm->most_inner, &lm->most_inner, NULL, 0));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmSetInnerSteps(EqmMethod method, PetscInt steps)
{
  PetscFunctionBegin;
  ((EqmLm *)method->data)->most_inner = steps;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmSetBalance(EqmMethod method, PetscReal epsilon)
{
  PetscFunctionBegin;
  ((EqmLm *)method->data)->epsilon = epsilon;
  PetscFunctionReturn(0);
}

static PetscErrorCode TrialCreate(EqmMethod method, EqmTrial *trial)
{
  const PetscInt n = method->problem->mesh->num_local_cells;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(method->problem->domain, &trial->place));
  PetscCall(PetscMalloc2(n, &trial->image, n, &trial->residual));
  if (method->problem->domain->curved_image) PetscCall(PetscMalloc2(n, &trial->half_det, n, &trial->lean));
  PetscFunctionReturn(0);
}

static PetscErrorCode TrialDestroy(EqmTrial *trial)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&trial->place));
  PetscCall(PetscFree2(trial->image, trial->residual));
  PetscCall(PetscFree2(trial->half_det, trial->lean));
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
  PetscCall(PetscMalloc3(num_cells, &lm->rate, num_cells, &lm->bend, num_cells, &lm->slope));
  PetscCall(PetscMalloc3(dim * mesh->num_local, &lm->velocity, dim * mesh->num_local, &lm->acceleration,
                         dim * mesh->num_owned, &lm->ambient));
  if (method->problem->domain->curved_image)
    PetscCall(PetscMalloc2(num_cells, &lm->lean_rate, num_cells, &lm->lean_bend));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &lm->descent));
  PetscCall(VecDuplicate(lm->descent, &lm->mean));
  PetscCall(VecDuplicate(lm->descent, &lm->step));
  PetscCall(VecDuplicate(lm->descent, &lm->curve));
  PetscCall(VecDuplicate(lm->descent, &lm->move));
  PetscCall(VecDuplicate(lm->descent, &lm->solved_mean));
  PetscCall(VecDuplicate(lm->descent, &lm->old_descent));
  PetscCall(VecDuplicate(lm->descent, &lm->direction));
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
            "; take -start guarded, or another start or method, or a better mesh",
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
  lm->mu = 1.;
  lm->angle_weight = lm->epsilon / problem->domain->target_measure;
  lm->kappa = problem->domain->curved_image ? 1. : 0.;
  PetscCall(EqmProblemCreateLinear(problem, EQM_MATRIX_COUPLED, &lm->linear));
  PetscCall(EqmLinearSetInexact(lm->linear, inexact));
  PetscCall(MakeRoom(method));
  PetscCall(VecSet(lm->mean, 0.)); /* where the residual has no mean it stays so */
  if (lm->epsilon > 0.) {
    PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &lm->laplacian));
    PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, lm->laplacian));
    lm->level = PetscLogReal(iterate->totals.total);
  }
  PetscCall(TakeStart(method, iterate));
  PetscFunctionReturn(0);
}

/* The factor and the pairs do not outlive an iteration. The objective follows the barrier's weight. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "damping", &lm->mu));
  PetscCall(EqmStateReal(state, "barrier_weight", &lm->kappa));
  if (EqmStateIsLoading(state)) EqmLmWeigh(method, &lm->now);
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLinearDestroy(&lm->linear));
  PetscCall(TrialDestroy(&lm->now));
  PetscCall(TrialDestroy(&lm->best));
  PetscCall(TrialDestroy(&lm->attempt));
  PetscCall(PetscFree3(lm->rate, lm->bend, lm->slope));
  PetscCall(PetscFree3(lm->velocity, lm->acceleration, lm->ambient));
  PetscCall(PetscFree2(lm->lean_rate, lm->lean_bend));
  PetscCall(PetscFree(lm->laplacian));
  PetscCall(VecDestroy(&lm->descent));
  PetscCall(VecDestroy(&lm->mean));
  PetscCall(VecDestroy(&lm->step));
  PetscCall(VecDestroy(&lm->curve));
  PetscCall(VecDestroy(&lm->move));
  PetscCall(VecDestroy(&lm->solved_mean));
  PetscCall(VecDestroy(&lm->old_descent));
  PetscCall(VecDestroy(&lm->direction));
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
  method->takes_landmarks = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
