/* Preconditioned nonlinear conjugate gradients (000 Algorithm 1), with refreshed preconditioner, other choices of beta
   and a safeguard. */
#include "method/method.h"
#include "domain/domain_private.h"

enum { BETA_FR, BETA_PR, BETA_HZ };
static const char *const ncg_betas[] = {"fletcher-reeves", "polak-ribiere", "hager-zhang",
                                        "EqmNcgBeta",      "EQM_NCG_",      NULL};

typedef struct {
  PetscInt refresh;
  PetscEnum beta;
  PetscBool guard;
  Vec gradient, preconditioned, direction, old_gradient, old_preconditioned, trial_gradient;
  EqmMetric metric;
  PetscReal *image;
  EqmPlace trial;
  PetscReal alpha;
} Ncg;

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricCreate(method->problem, &ncg->metric));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &ncg->image));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &ncg->gradient));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->preconditioned));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->direction));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->old_gradient));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->old_preconditioned));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->trial_gradient));
  PetscCall(EqmPlaceCreate(method->problem->domain, &ncg->trial));
  PetscCall(EqmMetricRefresh(ncg->metric, &iterate->place));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective,
                               ncg->gradient));
  PetscCall(VecNorm(ncg->gradient, NORM_2, &iterate->gradient_norm));
  PetscCall(EqmMetricApply(ncg->metric, &iterate->place, ncg->gradient, ncg->preconditioned));
  PetscCall(VecCopy(ncg->preconditioned, ncg->direction));
  PetscCall(VecScale(ncg->direction, -1.));
  ncg->alpha =
      2. *
      method->problem->domain->target_measure; /* 000 section 3.1, where the mesh has the area of the target, not one */
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricDestroy(&ncg->metric));
  PetscCall(PetscFree(ncg->image));
  PetscCall(VecDestroy(&ncg->gradient));
  PetscCall(VecDestroy(&ncg->preconditioned));
  PetscCall(VecDestroy(&ncg->direction));
  PetscCall(VecDestroy(&ncg->old_gradient));
  PetscCall(VecDestroy(&ncg->old_preconditioned));
  PetscCall(VecDestroy(&ncg->trial_gradient));
  PetscCall(EqmPlaceDestroy(&ncg->trial));
  PetscFunctionReturn(0);
}

static PetscErrorCode TryStep(EqmMethod method, EqmIterate iterate, PetscReal alpha, PetscReal *energy)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, ncg->direction, &ncg->trial));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &ncg->trial, ncg->image, energy, NULL));
  PetscFunctionReturn(0);
}

/* 000 (18): the minimum of the parabola through Phi(0), Phi'(0) and Phi at the previous step length. Where the parabola
   opens downward, the previous length is doubled; where the energy is not finite there is none. */
static PetscErrorCode ParabolaStep(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha)
{
  Ncg *const ncg = method->data;
  PetscReal energy, curvature;

  PetscFunctionBegin;
  PetscCall(TryStep(method, iterate, ncg->alpha, &energy));
  curvature = energy - iterate->objective - ncg->alpha * slope;
  if (PetscIsInfOrNanReal(energy))
    *alpha = .1 * ncg->alpha;
  else
    *alpha = curvature > 0. ? -ncg->alpha * ncg->alpha * slope / (2. * curvature) : 2. * ncg->alpha;
  PetscFunctionReturn(0);
}

/* Energy and gradient at the trial place for step length alpha. */
static PetscErrorCode TryGradient(EqmMethod method, EqmIterate iterate, PetscReal alpha, PetscReal *energy)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, ncg->direction, &ncg->trial));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &ncg->trial, ncg->image, energy, ncg->trial_gradient));
  PetscFunctionReturn(0);
}

/* Conditions of the convergence theorem that (18) does not ensure: sufficient decrease and an ordered boundary.
   The step is shortened until both hold; `alpha` 0 if none does. Leaves map, energy and gradient of the step in the
   trial. */
static PetscErrorCode Safeguard(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha,
                                PetscReal *energy)
{
  Ncg *const ncg = method->data;
  const PetscInt most_cuts = ncg->guard ? 30 : 0;

  PetscFunctionBegin;
  PetscCall(TryGradient(method, iterate, *alpha, energy));
  for (PetscInt cut = 0; cut < most_cuts; cut++) {
    PetscBool in_order;
    PetscCall(EqmDomainBoundaryInOrder(method->problem->domain, &ncg->trial, &in_order));
    if (in_order && *energy <= iterate->objective + 1e-4 * *alpha * slope) PetscFunctionReturn(0);
    const PetscReal curvature = *energy - iterate->objective - *alpha * slope,
                    parabola = -*alpha * *alpha * slope / (2. * curvature);
    *alpha = in_order && curvature > 0. ? PetscMin(.5 * *alpha, PetscMax(.1 * *alpha, parabola)) : .5 * *alpha;
    PetscCall(TryGradient(method, iterate, *alpha, energy));
  }
  if (most_cuts) *alpha = 0.;
  PetscFunctionReturn(0);
}

/* beta of 000 (19b), or of Polak and Ribiere (never negative), or of Hager and Zhang. */
static PetscErrorCode ComputeBeta(EqmMethod method, EqmIterate iterate, PetscReal old_product, PetscReal *beta)
{
  Ncg *const ncg = method->data;
  PetscReal product, cross;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &product));
  *beta = product / old_product;
  if ((int)ncg->beta == BETA_PR) {
    PetscCall(VecDot(ncg->preconditioned, ncg->old_gradient, &cross));
    *beta = PetscMax(0., (product - cross) / old_product);
  } else if ((int)ncg->beta == BETA_HZ) {
    PetscReal dy, yh, yy, dg;
    PetscCall(VecAYPX(ncg->old_gradient, -1., ncg->gradient)); /* y = g - g_old, in place of g_old */
    PetscCall(VecDot(ncg->direction, ncg->old_gradient, &dy));
    PetscCall(VecDot(ncg->preconditioned, ncg->old_gradient, &yh));
    PetscCall(VecAYPX(ncg->old_preconditioned, -1., ncg->preconditioned));
    PetscCall(VecDot(ncg->old_preconditioned, ncg->old_gradient, &yy));
    PetscCall(VecDot(ncg->direction, ncg->gradient, &dg));
    *beta = (yh - 2. * yy * dg / dy) / dy;
  }
  PetscFunctionReturn(0);
}

/* 000 Algorithm 1, lines 15-22. */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Ncg *const ncg = method->data;
  PetscReal slope, alpha, energy, old_product, beta = 0.;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->gradient, ncg->direction, &slope));
  if (slope >= 0.) { /* not a descent direction: restart */
    PetscCall(VecCopy(ncg->preconditioned, ncg->direction));
    PetscCall(VecScale(ncg->direction, -1.));
    PetscCall(VecDot(ncg->gradient, ncg->direction, &slope));
  }
  *outcome = EQM_STEP_STALLED;
  if (!(slope < 0.)) PetscFunctionReturn(0);
  PetscCall(ParabolaStep(method, iterate, slope, &alpha));
  PetscCall(Safeguard(method, iterate, slope, &alpha, &energy));
  if (alpha == 0. || PetscIsInfOrNanReal(energy)) PetscFunctionReturn(0);
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &old_product));
  PetscCall(VecCopy(ncg->gradient, ncg->old_gradient));
  PetscCall(VecCopy(ncg->preconditioned, ncg->old_preconditioned));
  PetscCall(EqmIterateAccept(method->problem, iterate, &ncg->trial, ncg->image, energy, alpha));
  ncg->alpha = alpha;
  PetscCall(VecCopy(ncg->trial_gradient, ncg->gradient));
  PetscCall(VecNorm(ncg->gradient, NORM_2, &iterate->gradient_norm));
  const PetscBool refreshed = (PetscBool)(ncg->refresh > 0 && (iterate->number + 1) % ncg->refresh == 0);
  if (refreshed) PetscCall(EqmMetricRefresh(ncg->metric, &iterate->place));
  PetscCall(EqmMetricApply(ncg->metric, &iterate->place, ncg->gradient, ncg->preconditioned));
  if (!refreshed) PetscCall(ComputeBeta(method, iterate, old_product, &beta));
  PetscCall(VecAXPBY(ncg->direction, -1., beta, ncg->preconditioned));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* SetUp recomputes gradient and preconditioned gradient, the latter with the factor of another map: the saved ones
   replace them. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricState(ncg->metric, state));
  PetscCall(EqmStateReal(state, "alpha", &ncg->alpha));
  PetscCall(EqmStateDofs(state, method->problem->domain, "direction", ncg->direction));
  PetscCall(EqmStateDofs(state, method->problem->domain, "preconditioned", ncg->preconditioned));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt(
      "-ncg_refresh", "ncg: renew the preconditioner every so many iterations and restart; 0: never (as printed)",
      "EqmSolverSetFromOptions", ncg->refresh, &ncg->refresh, NULL, 0));
  PetscCall(PetscOptionsEnum("-ncg_beta", "ncg: how the directions are conjugated", "EqmSolverSetFromOptions",
                             ncg_betas, ncg->beta, &ncg->beta, NULL));
  PetscCall(PetscOptionsBool("-ncg_guard",
                             "ncg: shorten a step of (18) that does not decrease the energy or disorders the boundary",
                             "EqmSolverSetFromOptions", ncg->guard, &ncg->guard, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateNcg(EqmMethod method)
{
  Ncg *ncg;

  PetscFunctionBegin;
  PetscCall(PetscNew(&ncg));
  ncg->guard = PETSC_TRUE;
  method->data = ncg;
  method->purpose = "preconditioned nonlinear conjugate gradients (000 Algorithm 1)";
  method->takes_terms = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
