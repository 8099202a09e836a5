/* The step lengths of the conjugate gradient method: 000 (18) as printed or guarded, and the strong Wolfe conditions
   (22), which the convergence theorem assumes and (18) does not give. */
#include "method/ncg.h"
#include "method/wolfe.h"
#include "domain/domain_private.h"

static PetscErrorCode TryStep(EqmMethod method, EqmIterate iterate, PetscReal alpha, PetscReal *energy)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, alpha, ncg->direction, &ncg->trial));
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &ncg->trial, ncg->image, energy, NULL));
  PetscFunctionReturn(0);
}

/* 000 (18): the minimum of the parabola through Phi(0), Phi'(0) and Phi at the previous step length. Where the parabola
   opens downward, the previous length is doubled, but for the printed algorithm, which takes the extremum whatever it
   is; where the energy is not finite there is none. */
static PetscErrorCode ParabolaStep(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha)
{
  Ncg *const ncg = method->data;
  PetscReal energy, curvature;

  PetscFunctionBegin;
  PetscCall(TryStep(method, iterate, ncg->alpha, &energy));
  curvature = energy - iterate->objective - ncg->alpha * slope;
  if ((int)ncg->search == EQM_NCG_PRINTED || curvature > 0.)
    *alpha = -ncg->alpha * ncg->alpha * slope / (2. * curvature);
  else
    *alpha = PetscIsInfOrNanReal(energy) ? .1 * ncg->alpha : 2. * ncg->alpha;
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

/* What the convergence theorem takes for granted and (18) does not give: sufficient decrease and an ordered boundary.
   The step is shortened until both hold; `alpha` 0 if none does. Leaves map, energy and gradient of the step in the
   trial. */
static PetscErrorCode Safeguard(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha,
                                PetscReal *energy)
{
  Ncg *const ncg = method->data;
  enum { MOST_CUTS = 30 };

  PetscFunctionBegin;
  PetscCall(TryGradient(method, iterate, *alpha, energy));
  for (PetscInt cut = 0; cut < MOST_CUTS; cut++) {
    PetscBool in_order;
    PetscCall(EqmDomainBoundaryInOrder(method->problem->domain, &ncg->trial, &in_order));
    if (in_order && *energy <= iterate->objective + 1e-4 * *alpha * slope) PetscFunctionReturn(0);
    const PetscReal curvature = *energy - iterate->objective - *alpha * slope,
                    parabola = -*alpha * *alpha * slope / (2. * curvature);
    *alpha = in_order && curvature > 0. ? PetscMin(.5 * *alpha, PetscMax(.1 * *alpha, parabola)) : .5 * *alpha;
    PetscCall(TryGradient(method, iterate, *alpha, energy));
  }
  *alpha = 0.;
  PetscFunctionReturn(0);
}

typedef struct {
  EqmMethod method;
  EqmIterate iterate;
  PetscReal unit; /* the step length at t = 1 */
} Along;

/* A boundary out of order is as good as no map. */
static PetscErrorCode TryWolfe(void *context, PetscReal t, PetscReal *value, PetscReal *slope)
{
  const Along *const along = context;
  Ncg *const ncg = along->method->data;
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(TryGradient(along->method, along->iterate, t * along->unit, value));
  PetscCall(VecDot(ncg->trial_gradient, ncg->direction, slope));
  *slope *= along->unit;
  PetscCall(EqmDomainBoundaryInOrder(along->method->problem->domain, &ncg->trial, &in_order));
  if (!in_order) *value = INFINITY;
  PetscFunctionReturn(0);
}

/* The parabola's minimum is tried first. */
static PetscErrorCode SearchByWolfe(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha,
                                    PetscReal *energy)
{
  Along along = {method, iterate, 1.};
  PetscReal t;

  PetscFunctionBegin;
  PetscCall(ParabolaStep(method, iterate, slope, &along.unit));
  PetscCall(
      EqmWolfeSearch(TryWolfe, &along, iterate->objective, along.unit * slope, ((Ncg *)method->data)->c2, &t, energy));
  *alpha = t * along.unit;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmNcgSearch(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha, PetscReal *energy)
{
  Ncg *const ncg = method->data;

  PetscFunctionBegin;
  if ((int)ncg->search == EQM_NCG_WOLFE) {
    PetscCall(SearchByWolfe(method, iterate, slope, alpha, energy));
    PetscFunctionReturn(0);
  }
  PetscCall(ParabolaStep(method, iterate, slope, alpha));
  if ((int)ncg->search == EQM_NCG_PRINTED)
    PetscCall(TryGradient(method, iterate, *alpha, energy));
  else
    PetscCall(Safeguard(method, iterate, slope, alpha, energy));
  PetscFunctionReturn(0);
}
