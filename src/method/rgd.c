/* Riemannian gradient descent (001 Algorithm 1) with the two line searches of the paper. */
#include "method/method.h"
#include "mesh/mesh_private.h"
#include "method/brent.h"

typedef enum { SEARCH_INTERPOLATION, SEARCH_BRENT } RgdLineSearch;
static const char *const line_searches[] = {"interpolation", "brent", "EqmRgdLineSearch", "EQM_RGD_", NULL};

typedef struct {
  PetscEnum line_search; /* an RgdLineSearch */
  PetscReal *image;
  EqmPlace trial;
  Vec gradient, direction;
} Rgd;

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  Rgd *const rgd = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(method->problem->domain, &rgd->trial));
  PetscCall(PetscMalloc1(method->problem->mesh->num_local_cells, &rgd->image));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &rgd->gradient));
  PetscCall(VecDuplicate(rgd->gradient, &rgd->direction));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective,
                               rgd->gradient));
  PetscCall(VecNorm(rgd->gradient, NORM_2, &iterate->gradient_norm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Rgd *const rgd = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&rgd->trial));
  PetscCall(PetscFree(rgd->image));
  PetscCall(VecDestroy(&rgd->gradient));
  PetscCall(VecDestroy(&rgd->direction));
  PetscFunctionReturn(0);
}

/* phi(alpha) of 001 Appendix C, less phi(0). */
static PetscErrorCode Phi(void *context, PetscReal alpha, PetscReal *value)
{
  const EqmMethod method = context;
  const EqmIterate iterate = method->iterate;
  Rgd *const rgd = method->data;
  PetscReal energy;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, rgd->direction, &rgd->trial));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &rgd->trial, rgd->image, &energy, NULL));
  *value = energy - iterate->objective;
  PetscFunctionReturn(0);
}

/* 001 Appendix C: from alpha = .1, the parabola's minimum first, the cubic's afterwards (its quadratic coefficient with
   the 1/alpha^2 that the paper lost), each clamped to [.1, .5] of the last try. 0: no decrease. */
static PetscErrorCode Interpolate(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha)
{
  enum { MOST_TRIALS = 50 };
  PetscReal value, old_alpha = 0., old_value = 0.;

  PetscFunctionBegin;
  *alpha = .1;
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscReal next;
    PetscCall(Phi(method, *alpha, &value));
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

/* Bounded minimisation on (0, 1) by Brent's method; the paper uses a library routine. 0: no decrease. */
static PetscErrorCode Minimise(EqmMethod method, EqmIterate iterate, PetscReal *alpha)
{
  PetscReal value;

  PetscFunctionBegin;
  PetscCall(EqmBrentSearch(Phi, method, alpha, &value));
  if (!(value < 0.)) *alpha = 0.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Rgd *const rgd = method->data;
  PetscReal alpha;

  PetscFunctionBegin;
  PetscCall(VecCopy(rgd->gradient, rgd->direction));
  PetscCall(VecScale(rgd->direction, -1.));
  if ((int)rgd->line_search == SEARCH_BRENT)
    PetscCall(Minimise(method, iterate, &alpha));
  else
    PetscCall(Interpolate(method, iterate, -PetscSqr(iterate->gradient_norm), &alpha));
  *outcome = EQM_STEP_STALLED;
  if (alpha == 0.) PetscFunctionReturn(0);
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, rgd->direction, &iterate->place));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective,
                               rgd->gradient));
  PetscCall(EqmIterateUpdateTotals(method->problem, iterate));
  PetscCall(VecNorm(rgd->gradient, NORM_2, &iterate->gradient_norm));
  iterate->step_length = alpha;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  Rgd *const rgd = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEnum("-rgd_line_search", "rgd: how the step length is found", "EqmSolverSetFromOptions",
                             line_searches, rgd->line_search, &rgd->line_search, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateRgd(EqmMethod method)
{
  Rgd *rgd;

  PetscFunctionBegin;
  PetscCall(PetscNew(&rgd));
  method->data = rgd;
  method->purpose = "Riemannian gradient descent (001 Algorithm 1)";
  method->takes_terms = PETSC_TRUE;
  method->ops = (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .reset = Reset};
  PetscFunctionReturn(0);
}
