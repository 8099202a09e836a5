/* Preconditioned nonlinear conjugate gradients (000 Algorithm 1), with refreshed preconditioner, other betas and a
 * guard. */
#include "method/method.h"

enum { BETA_FR, BETA_PR, BETA_HZ };
static const char *const ncg_betas[] = {"fletcher-reeves", "polak-ribiere", "hager-zhang",
                                        "EqmNcgBeta",      "EQM_NCG_",      NULL};

typedef struct {
  Vec gradient, preconditioned, direction, old_gradient, old_preconditioned, trial_gradient;
  EqmMetric metric;
  PetscReal *image;
  EqmPlace trial;
  PetscReal alpha;
} Ncg;

static PetscErrorCode SetUp(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  Ncg *ncg;

  PetscFunctionBegin;
  PetscCall(PetscNew(&ncg));
  solver->data = ncg;
  PetscCall(EqmMetricCreate(solver, &ncg->metric));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &ncg->image));
  PetscCall(EqmDomainCreateVec(solver->domain, &ncg->gradient));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->preconditioned));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->direction));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->old_gradient));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->old_preconditioned));
  PetscCall(VecDuplicate(ncg->gradient, &ncg->trial_gradient));
  PetscCall(EqmPlaceCreate(solver->domain, &ncg->trial));
  PetscCall(EqmMetricRefresh(solver, ncg->metric));
  PetscCall(
      solver->problem->objective->evaluate(solver, &solver->place, solver->image, &solver->objective, ncg->gradient));
  PetscCall(VecNorm(ncg->gradient, NORM_2, &solver->gradient_norm));
  PetscCall(EqmMetricApply(solver, ncg->metric, ncg->gradient, ncg->preconditioned));
  PetscCall(VecCopy(ncg->preconditioned, ncg->direction));
  PetscCall(VecScale(ncg->direction, -1.));
  ncg->alpha =
      2. * solver->domain->target_measure; /* 000 section 3.1, where the mesh has the area of the target, not one */
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Ncg *const ncg = solver->data;

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
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

static PetscErrorCode TryStep(EqmSolver solver, PetscReal alpha, PetscReal *energy)
{
  Ncg *const ncg = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(solver->domain, &solver->place, alpha, ncg->direction, &ncg->trial));
  PetscCall(solver->problem->objective->evaluate(solver, &ncg->trial, ncg->image, energy, NULL));
  PetscFunctionReturn(0);
}

/* 000 (18): the minimum of the parabola through Phi(0), Phi'(0) and Phi at the previous step length. Where the parabola
   opens downward, the previous length is doubled; where the energy is not finite there is none. */
static PetscErrorCode ParabolaStep(EqmSolver solver, PetscReal slope, PetscReal *alpha)
{
  Ncg *const ncg = solver->data;
  PetscReal energy, curvature;

  PetscFunctionBegin;
  PetscCall(TryStep(solver, ncg->alpha, &energy));
  curvature = energy - solver->objective - ncg->alpha * slope;
  if (PetscIsInfOrNanReal(energy))
    *alpha = .1 * ncg->alpha;
  else
    *alpha = curvature > 0. ? -ncg->alpha * ncg->alpha * slope / (2. * curvature) : 2. * ncg->alpha;
  PetscFunctionReturn(0);
}

/* Energy and gradient at the trial place for step length alpha. */
static PetscErrorCode TryGradient(EqmSolver solver, PetscReal alpha, PetscReal *energy)
{
  Ncg *const ncg = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(solver->domain, &solver->place, alpha, ncg->direction, &ncg->trial));
  PetscCall(solver->problem->objective->evaluate(solver, &ncg->trial, ncg->image, energy, ncg->trial_gradient));
  PetscFunctionReturn(0);
}

/* What the convergence theorem takes for granted and (18) does not give: sufficient decrease and an ordered boundary.
   The step is shortened until both hold; `alpha` 0 if none does. Leaves map, energy and gradient of the step in the
   trial. */
static PetscErrorCode Safeguard(EqmSolver solver, PetscReal slope, PetscReal *alpha, PetscReal *energy)
{
  Ncg *const ncg = solver->data;
  const PetscInt most_cuts = solver->settings.ncg_guard ? 30 : 0;

  PetscFunctionBegin;
  PetscCall(TryGradient(solver, *alpha, energy));
  for (PetscInt cut = 0; cut < most_cuts; cut++) {
    PetscBool in_order;
    PetscCall(EqmDomainBoundaryInOrder(solver->domain, &ncg->trial, &in_order));
    if (in_order && *energy <= solver->objective + 1e-4 * *alpha * slope) PetscFunctionReturn(0);
    const PetscReal curvature = *energy - solver->objective - *alpha * slope,
                    parabola = -*alpha * *alpha * slope / (2. * curvature);
    *alpha = in_order && curvature > 0. ? PetscMin(.5 * *alpha, PetscMax(.1 * *alpha, parabola)) : .5 * *alpha;
    PetscCall(TryGradient(solver, *alpha, energy));
  }
  if (most_cuts) *alpha = 0.;
  PetscFunctionReturn(0);
}

/* beta of 000 (19b), or of Polak and Ribiere (never negative), or of Hager and Zhang. */
static PetscErrorCode ComputeBeta(EqmSolver solver, PetscReal old_product, PetscReal *beta)
{
  Ncg *const ncg = solver->data;
  PetscReal product, cross;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &product));
  *beta = product / old_product;
  if ((int)solver->settings.ncg_beta == BETA_PR) {
    PetscCall(VecDot(ncg->preconditioned, ncg->old_gradient, &cross));
    *beta = PetscMax(0., (product - cross) / old_product);
  } else if ((int)solver->settings.ncg_beta == BETA_HZ) {
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
static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Ncg *const ncg = solver->data;
  PetscReal slope, alpha, energy, old_product, beta = 0.;
  const PetscInt refresh = solver->settings.ncg_refresh;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->gradient, ncg->direction, &slope));
  if (slope >= 0.) { /* not a descent direction: restart */
    PetscCall(VecCopy(ncg->preconditioned, ncg->direction));
    PetscCall(VecScale(ncg->direction, -1.));
    PetscCall(VecDot(ncg->gradient, ncg->direction, &slope));
  }
  *outcome = EQM_STEP_STALLED;
  if (!(slope < 0.)) PetscFunctionReturn(0);
  PetscCall(ParabolaStep(solver, slope, &alpha));
  PetscCall(Safeguard(solver, slope, &alpha, &energy));
  if (alpha == 0. || PetscIsInfOrNanReal(energy)) PetscFunctionReturn(0);
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &old_product));
  PetscCall(VecCopy(ncg->gradient, ncg->old_gradient));
  PetscCall(VecCopy(ncg->preconditioned, ncg->old_preconditioned));
  PetscCall(EqmSolverAccept(solver, &ncg->trial, ncg->image, energy, alpha));
  ncg->alpha = alpha;
  PetscCall(VecCopy(ncg->trial_gradient, ncg->gradient));
  PetscCall(VecNorm(ncg->gradient, NORM_2, &solver->gradient_norm));
  const PetscBool refreshed = (PetscBool)(refresh > 0 && (solver->iteration + 1) % refresh == 0);
  if (refreshed) PetscCall(EqmMetricRefresh(solver, ncg->metric));
  PetscCall(EqmMetricApply(solver, ncg->metric, ncg->gradient, ncg->preconditioned));
  if (!refreshed) PetscCall(ComputeBeta(solver, old_product, &beta));
  PetscCall(VecAXPBY(ncg->direction, -1., beta, ncg->preconditioned));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* SetUp makes gradient and preconditioned gradient anew, the latter with the factor of another map. */
static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Ncg *const ncg = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmMetricState(solver, ncg->metric, state));
  PetscCall(EqmStateReal(state, "alpha", &ncg->alpha));
  PetscCall(EqmStateDofs(state, solver->domain, "direction", ncg->direction));
  PetscCall(EqmStateDofs(state, solver->domain, "preconditioned", ncg->preconditioned));
  PetscFunctionReturn(0);
}

static PetscErrorCode Options(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt(
      "-ncg_refresh", "ncg: renew the preconditioner every so many iterations and restart; 0: never (as printed)",
      "EqmSolverSetFromOptions", solver->settings.ncg_refresh, &solver->settings.ncg_refresh, NULL, 0));
  PetscCall(PetscOptionsEnum("-ncg_beta", "ncg: how the directions are conjugated", "EqmSolverSetFromOptions",
                             ncg_betas, solver->settings.ncg_beta, &solver->settings.ncg_beta, NULL));
  PetscCall(PetscOptionsBool("-ncg_guard",
                             "ncg: shorten a step of (18) that does not decrease the energy or disorders the boundary",
                             "EqmSolverSetFromOptions", solver->settings.ncg_guard, &solver->settings.ncg_guard, NULL));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodNcg = {
    .name = "ncg",
    .purpose = "preconditioned nonlinear conjugate gradients (000 Algorithm 1)",
    .options = Options,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
