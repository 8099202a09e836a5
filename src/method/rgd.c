/* Riemannian gradient descent (001 Algorithm 1) with the two line searches of the paper. */
#include "method/method.h"
#include "mesh/mesh_private.h"
#include "method/brent.h"

typedef enum { SEARCH_INTERPOLATION, SEARCH_BRENT } RgdLineSearch;
static const char *const line_searches[] = {"interpolation", "brent", "EqmRgdLineSearch", "EQM_RGD_", NULL};
typedef enum { FIRST_TRIAL_CONSTANT, FIRST_TRIAL_NOCEDAL_WRIGHT } RgdFirstTrial;
static const char *const first_trials[] = {"constant", "nocedal-wright", "EqmRgdFirstTrial", "EQM_RGD_", NULL};

typedef struct {
  PetscEnum line_search, first_trial; /* an RgdLineSearch, an RgdFirstTrial */
  PetscReal alpha0;                   /* the first trial of the first step, or of all */
  PetscBool clamp;
  PetscReal fall; /* objective before the last step less that after it; 0: there was none */
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
  rgd->fall = 0.;
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

/* Where the search begins: always at the same place, or where a step as good as the last one would lead, 001 Appendix C
   from Nocedal and Wright (3.60). */
static PetscReal FirstTrial(const Rgd *rgd, PetscReal slope)
{
  if ((int)rgd->first_trial == FIRST_TRIAL_CONSTANT || !(rgd->fall > 0.)) return rgd->alpha0;
  return -2. * rgd->fall / slope;
}

/* Two trials of the search; value - phi there less phi(0). */
typedef struct {
  PetscReal alpha, value;
} Trial;

/* The minimum of the cubic through both trials with phi's slope at 0 (001 Appendix C, its quadratic coefficient with
   the 1/alpha^2 that the paper lost); half of the last where there is none. */
static PetscReal CubicMinimum(Trial now, Trial old, PetscReal slope)
{
  const PetscReal r = (now.value - slope * now.alpha) / (now.alpha * now.alpha),
                  s = (old.value - slope * old.alpha) / (old.alpha * old.alpha), width = now.alpha - old.alpha;
  const PetscReal a = (r - s) / width, b = (-old.alpha * r + now.alpha * s) / width;
  const PetscReal discriminant = b * b - 3. * a * slope;

  return discriminant >= 0. && a != 0. ? (-b + PetscSqrtReal(discriminant)) / (3. * a) : .5 * now.alpha;
}

/* 001 Appendix C: the parabola's minimum first, the cubic's afterwards; clamped to [.1, .5] of the last trial, or as
   they are. 0: no decrease. */
static PetscErrorCode Interpolate(EqmMethod method, PetscReal slope, PetscReal *alpha)
{
  enum { MOST_TRIALS = 50 };
  const Rgd *const rgd = method->data;
  Trial now = {.alpha = FirstTrial(rgd, slope)}, old = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscReal next;
    PetscCall(Phi(method, now.alpha, &now.value));
    *alpha = now.alpha;
    if (now.value <= 1e-4 * now.alpha * slope) PetscFunctionReturn(0);
    next = trial == 0 ? -slope * now.alpha * now.alpha / (2. * (now.value - slope * now.alpha))
                      : CubicMinimum(now, old, slope);
    if (rgd->clamp) next = PetscMin(.5 * now.alpha, PetscMax(.1 * now.alpha, next));
    if (!(next > 0. && next < now.alpha)) next = .5 * now.alpha; /* no number, or no way back */
    old = now;
    now.alpha = next;
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
  const PetscReal before = iterate->objective;
  PetscReal alpha;

  PetscFunctionBegin;
  PetscCall(VecCopy(rgd->gradient, rgd->direction));
  PetscCall(VecScale(rgd->direction, -1.));
  if ((int)rgd->line_search == SEARCH_BRENT)
    PetscCall(Minimise(method, iterate, &alpha));
  else
    PetscCall(Interpolate(method, -PetscSqr(iterate->gradient_norm), &alpha));
  *outcome = EQM_STEP_STALLED;
  if (alpha == 0.) PetscFunctionReturn(0);
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, rgd->direction, &iterate->place));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective,
                               rgd->gradient));
  PetscCall(EqmIterateUpdateTotals(method->problem, iterate));
  PetscCall(VecNorm(rgd->gradient, NORM_2, &iterate->gradient_norm));
  iterate->step_length = alpha;
  rgd->fall = before - iterate->objective;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* SetUp makes the gradient anew. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Rgd *const rgd = method->data;

  PetscFunctionBegin;
  (void)iterate;
  PetscCall(EqmStateReal(state, "fall", &rgd->fall));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  Rgd *const rgd = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEnum("-rgd_line_search", "rgd: how the step length is found", "EqmSolverSetFromOptions",
                             line_searches, rgd->line_search, &rgd->line_search, NULL));
  PetscCall(PetscOptionsReal("-rgd_alpha0", "rgd, interpolation: the step length that is tried first",
                             "EqmSolverSetFromOptions", rgd->alpha0, &rgd->alpha0, NULL));
  if (!(rgd->alpha0 > 0.) || PetscIsInfOrNanReal(rgd->alpha0))
    EqmFail(method->comm, EQM_ERR_USAGE, "-rgd_alpha0 %.6g: give a length above 0", (double)rgd->alpha0);
  PetscCall(PetscOptionsEnum("-rgd_first_trial",
                             "rgd, interpolation: try -rgd_alpha0 first in every step, or after the first one the "
                             "length of Nocedal and Wright (3.60)",
                             "EqmSolverSetFromOptions", first_trials, rgd->first_trial, &rgd->first_trial, NULL));
  PetscCall(PetscOptionsBool("-rgd_clamp",
                             "rgd, interpolation: keep each trial between a tenth and a half of the one before",
                             "EqmSolverSetFromOptions", rgd->clamp, &rgd->clamp, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateRgd(EqmMethod method)
{
  Rgd *rgd;

  PetscFunctionBegin;
  PetscCall(PetscNew(&rgd));
  rgd->alpha0 = .1;
  rgd->clamp = PETSC_TRUE;
  method->data = rgd;
  method->purpose = "Riemannian gradient descent (001 Algorithm 1)";
  method->takes_terms = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
