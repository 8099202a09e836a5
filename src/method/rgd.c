/* Riemannian gradient descent (001 Algorithm 1) with the two line searches of the paper. */
#include "method/method.h"
#include "method/brent.h"

typedef enum { SEARCH_INTERPOLATION, SEARCH_BRENT } RgdLineSearch;
static const char *const line_searches[] = {"interpolation", "brent", "EqmRgdLineSearch", "EQM_RGD_", NULL};

typedef struct {
  PetscReal *image;
  EqmPlace trial;
  Vec gradient, direction;
} Rgd;

static PetscErrorCode SetUp(EqmSolver solver)
{
  Rgd *rgd;

  PetscFunctionBegin;
  PetscCall(PetscNew(&rgd));
  solver->data = rgd;
  PetscCall(EqmPlaceCreate(solver->domain, &rgd->trial));
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &rgd->image));
  PetscCall(EqmDomainCreateVec(solver->domain, &rgd->gradient));
  PetscCall(VecDuplicate(rgd->gradient, &rgd->direction));
  PetscCall(
      solver->problem->objective->evaluate(solver, &solver->place, solver->image, &solver->objective, rgd->gradient));
  PetscCall(VecNorm(rgd->gradient, NORM_2, &solver->gradient_norm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Rgd *const rgd = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&rgd->trial));
  PetscCall(PetscFree(rgd->image));
  PetscCall(VecDestroy(&rgd->gradient));
  PetscCall(VecDestroy(&rgd->direction));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* phi(alpha) of 001 Appendix C, less phi(0). */
static PetscErrorCode Phi(void *context, PetscReal alpha, PetscReal *value)
{
  const EqmSolver solver = context;
  Rgd *const rgd = solver->data;
  PetscReal energy;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(solver->domain, &solver->place, alpha, rgd->direction, &rgd->trial));
  PetscCall(solver->problem->objective->evaluate(solver, &rgd->trial, rgd->image, &energy, NULL));
  *value = energy - solver->objective;
  PetscFunctionReturn(0);
}

/* 001 Appendix C: from alpha = .1, the parabola's minimum first, the cubic's afterwards (its quadratic coefficient with
   the 1/alpha^2 that the paper lost), each clamped to [.1, .5] of the last try. 0: no decrease. */
static PetscErrorCode Interpolate(EqmSolver solver, PetscReal slope, PetscReal *alpha)
{
  enum { MOST_TRIALS = 50 };
  PetscReal value, old_alpha = 0., old_value = 0.;

  PetscFunctionBegin;
  *alpha = .1;
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscReal next;
    PetscCall(Phi(solver, *alpha, &value));
    if (value <= 1e-4 * *alpha * slope) PetscFunctionReturn(0);
    if (trial == 0) {
      next = -slope * *alpha * *alpha / (2. * (value - slope * *alpha));
    } else {
      const PetscReal r = value - slope * *alpha, s = old_value - slope * old_alpha, width = *alpha - old_alpha;
      const PetscReal a = (r / (*alpha * *alpha) - s / (old_alpha * old_alpha)) / width;
      const PetscReal b = (-old_alpha * r / (*alpha * *alpha) + *alpha * s / (old_alpha * old_alpha)) / width;
      const PetscReal discriminant = b * b - 3. * a * slope;
      next = discriminant >= 0. && a != 0. ? (-b + PetscSqrtReal(discriminant)) / (3. * a) : .5 * *alpha;
    }
    old_alpha = *alpha;
    old_value = value;
    *alpha = PetscMin(.5 * *alpha, PetscMax(.1 * *alpha, next));
  }
  *alpha = 0.;
  PetscFunctionReturn(0);
}

/* On (0, 1) by Brent's method, which the paper takes from its environment. 0: no decrease. */
static PetscErrorCode Minimise(EqmSolver solver, PetscReal *alpha)
{
  PetscReal value;

  PetscFunctionBegin;
  PetscCall(EqmBrentSearch(Phi, solver, alpha, &value));
  if (!(value < 0.)) *alpha = 0.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Rgd *const rgd = solver->data;
  PetscReal alpha;

  PetscFunctionBegin;
  PetscCall(VecCopy(rgd->gradient, rgd->direction));
  PetscCall(VecScale(rgd->direction, -1.));
  if ((int)solver->settings.rgd_line_search == SEARCH_BRENT)
    PetscCall(Minimise(solver, &alpha));
  else
    PetscCall(Interpolate(solver, -PetscSqr(solver->gradient_norm), &alpha));
  *outcome = EQM_STEP_STALLED;
  if (alpha == 0.) PetscFunctionReturn(0);
  PetscCall(EqmDomainMove(solver->domain, &solver->place, alpha, rgd->direction, &solver->place));
  PetscCall(
      solver->problem->objective->evaluate(solver, &solver->place, solver->image, &solver->objective, rgd->gradient));
  PetscCall(EqmSolverSum(solver));
  PetscCall(VecNorm(rgd->gradient, NORM_2, &solver->gradient_norm));
  solver->step_length = alpha;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode Options(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsEnum("-rgd_line_search", "rgd: how the step length is found", "EqmSolverSetFromOptions",
                             line_searches, solver->settings.rgd_line_search, &solver->settings.rgd_line_search, NULL));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodRgd = {
    .name = "rgd",
    .purpose = "Riemannian gradient descent (001 Algorithm 1)",
    .options = Options,
    .set_up = SetUp,
    .step = Step,
    .destroy = Destroy,
};
