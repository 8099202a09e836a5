/* Preconditioned nonlinear conjugate gradients (000 Algorithm 1), with refreshed preconditioner and other betas. */
#include "method/ncg.h"
#include "domain/domain_private.h"

static const char *const ncg_betas[] = {"fletcher-reeves", "polak-ribiere", "hager-zhang",
                                        "EqmNcgBeta",      "EQM_NCG_",      NULL};
static const char *const ncg_searches[] = {"guarded", "printed", "wolfe", "EqmNcgSearch", "EQM_NCG_", NULL};

/* ||g|| in the norm of M^-1, which 000 Theorem 2 takes to zero. */
static PetscErrorCode TakeNorms(EqmMethod method, EqmIterate iterate)
{
  Ncg *const ncg = method->data;
  PetscReal product;

  PetscFunctionBegin;
  PetscCall(VecNorm(ncg->gradient, NORM_2, &iterate->gradient_norm));
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &product));
  iterate->figures.preconditioned_norm = PetscSqrtReal(PetscMax(product, 0.));
  PetscFunctionReturn(0);
}

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
  PetscCall(EqmMetricApply(ncg->metric, &iterate->place, ncg->gradient, ncg->preconditioned));
  PetscCall(TakeNorms(method, iterate));
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

/* beta of 000 (19b), or of Polak and Ribiere (never negative), or of Hager and Zhang. */
static PetscErrorCode ComputeBeta(EqmMethod method, EqmIterate iterate, PetscReal old_product, PetscReal *beta)
{
  Ncg *const ncg = method->data;
  PetscReal product, cross;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &product));
  *beta = product / old_product;
  if ((int)ncg->beta == EQM_NCG_POLAK_RIBIERE) {
    PetscCall(VecDot(ncg->preconditioned, ncg->old_gradient, &cross));
    *beta = PetscMax(0., (product - cross) / old_product);
  } else if ((int)ncg->beta == EQM_NCG_HAGER_ZHANG) {
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

/* The trial becomes the iterate; both sides of 000 (22), each divided by what c1 and c2 stand before. */
static PetscErrorCode Accept(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal alpha, PetscReal energy)
{
  Ncg *const ncg = method->data;
  PetscReal new_slope;

  PetscFunctionBegin;
  PetscCall(VecCopy(ncg->gradient, ncg->old_gradient));
  PetscCall(VecCopy(ncg->preconditioned, ncg->old_preconditioned));
  PetscCall(VecDot(ncg->trial_gradient, ncg->direction, &new_slope));
  iterate->figures.wolfe_decrease = (energy - iterate->objective) / (alpha * slope);
  iterate->figures.wolfe_slope = PetscAbsReal(new_slope / slope);
  PetscCall(EqmIterateAccept(method->problem, iterate, &ncg->trial, ncg->image, energy, alpha));
  ncg->alpha = alpha;
  PetscCall(VecCopy(ncg->trial_gradient, ncg->gradient));
  PetscFunctionReturn(0);
}

/* g^T p; but for the printed algorithm, what is no descent direction gives way to one. */
static PetscErrorCode FindSlope(EqmMethod method, PetscReal *slope)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(VecDot(ncg->gradient, ncg->direction, slope));
  if (*slope < 0. || (int)ncg->search == EQM_NCG_PRINTED) PetscFunctionReturn(0);
  PetscCall(VecCopy(ncg->preconditioned, ncg->direction));
  PetscCall(VecScale(ncg->direction, -1.));
  PetscCall(VecDot(ncg->gradient, ncg->direction, slope));
  PetscFunctionReturn(0);
}

/* 000 Algorithm 1, lines 15-22. */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Ncg *const ncg = method->data;
  PetscReal slope, alpha, energy, old_product, beta = 0.;

  PetscFunctionBegin;
  PetscCall(FindSlope(method, &slope));
  *outcome = EQM_STEP_STALLED;
  if (slope == 0. || ((int)ncg->search != EQM_NCG_PRINTED && !(slope < 0.))) PetscFunctionReturn(0);
  PetscCall(EqmNcgSearch(method, iterate, slope, &alpha, &energy));
  if (alpha == 0. || PetscIsInfOrNanReal(energy)) PetscFunctionReturn(0);
  PetscCall(VecDot(ncg->preconditioned, ncg->gradient, &old_product));
  PetscCall(Accept(method, iterate, slope, alpha, energy));
  const PetscBool refreshed = (PetscBool)(ncg->refresh > 0 && (iterate->number + 1) % ncg->refresh == 0);
  if (refreshed) PetscCall(EqmMetricRefresh(ncg->metric, &iterate->place));
  PetscCall(EqmMetricApply(ncg->metric, &iterate->place, ncg->gradient, ncg->preconditioned));
  PetscCall(TakeNorms(method, iterate));
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
  PetscCall(PetscOptionsEnum("-ncg_line_search",
                             "ncg: how the step length is found: guarded, by the parabola of 000 (18), shortened where "
                             "that does not decrease the energy or disorders the boundary; printed, by (18) alone; "
                             "wolfe, such that the strong Wolfe conditions (22) hold",
                             "EqmSolverSetFromOptions", ncg_searches, ncg->search, &ncg->search, NULL));
  PetscCall(PetscOptionsReal("-ncg_c2", "ncg, wolfe: c2 of (22b), which 000 Theorem 2 wants below one half",
                             "EqmSolverSetFromOptions", ncg->c2, &ncg->c2, NULL));
  if (!(ncg->c2 > 1e-4 && ncg->c2 < 1.))
    EqmFail(method->comm, EQM_ERR_USAGE, "-ncg_c2 %.6g: give a number between c1 = 1e-4 and 1; the theorem wants < .5",
            (double)ncg->c2);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateNcg(EqmMethod method)
{
  Ncg *ncg;

  PetscFunctionBegin;
  PetscCall(PetscNew(&ncg));
  ncg->c2 = .4;
  method->data = ncg;
  method->purpose = "preconditioned nonlinear conjugate gradients (000 Algorithm 1)";
  method->takes_terms = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
