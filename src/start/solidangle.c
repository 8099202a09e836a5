/* A first map of equal areas on the sphere itself, for surfaces with limbs. There triangles are drawn out, and a flat
   one that spans a long arc has the more area the further it is tipped: flat areas become equal by tipping it over, and
   then no step helps. The area on the sphere, the solid angle, vanishes with a triangle that tips over, and the way
   to equal ones is open from any map without folds. With a weight on the angles and on the triangles' tilt they end
   short and upright, so that of flat areas little is left to change. */
#include "start/start.h"
#include "domain/domain_private.h"
#include "method/method.h"

/* Weights of the angle energy, one after the other, and of the squared logarithms of tilt beside those of ratios. */
static const PetscReal balances[] = {.1, .01}, upright_weight = 1.;

/* lm, until a step decreases the objective by less than a twentieth, or there is none. */
static PetscErrorCode Minimise(EqmProblem problem, EqmIterate iterate, EqmMethod lm)
{
  enum { MOST_STEPS = 30 };
  const PetscReal least_fall = .05;
  EqmStep outcome = EQM_STEP_TAKEN;

  PetscFunctionBegin;
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscCall(EqmMethodSetUp(lm, problem, iterate));
  for (PetscInt k = 0; k < MOST_STEPS && outcome == EQM_STEP_TAKEN; k++) {
    const PetscReal before = iterate->objective;
    PetscCall(EqmMethodStep(lm, iterate, &outcome));
    if (before - iterate->objective < least_fall * before) break;
  }
  PetscCall(EqmMethodReset(lm));
  PetscFunctionReturn(0);
}

static PetscErrorCode TakeOut(EqmProblem problem, EqmTerm term)
{
  PetscFunctionBegin;
  PetscCall(EqmProblemRemoveTerm(problem, term));
  PetscCall(term->destroy(term));
  PetscFunctionReturn(0);
}

/* Solid angles balanced with angles and tilt. */
static PetscErrorCode Balance(EqmProblem problem, EqmIterate iterate)
{
  EqmMethod lm;
  EqmTerm angle, upright;

  PetscFunctionBegin;
  PetscCall(EqmMethodCreate(problem->comm, "lm", &lm));
  PetscCall(EqmTermCreateUpright(problem, upright_weight * problem->domain->target_measure, &upright));
  PetscCall(EqmProblemAddTerm(problem, upright));
  for (size_t k = 0; k < sizeof(balances) / sizeof(balances[0]); k++) {
    PetscCall(EqmTermCreateAngle(problem, balances[k], &angle));
    PetscCall(EqmProblemAddTerm(problem, angle));
    PetscCall(Minimise(problem, iterate, lm));
    PetscCall(TakeOut(problem, angle));
  }
  PetscCall(TakeOut(problem, upright));
  PetscCall(EqmMethodDestroy(&lm));
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  EqmDomain const domain = problem->domain;
  const EqmMeasureKind measure = domain->measure;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(EqmStartSphereCascade.run(problem, iterate, options));
  PetscCall(EqmPlaceMakeFrames(domain, &iterate->place));
  PetscCall(EqmIterateUpdate(problem, iterate));
  if (iterate->totals.folds > 0) PetscFunctionReturn(0);
  domain->measure = EQM_MEASURE_SOLID_ANGLE;
  error = Balance(problem, iterate);
  domain->measure = measure; /* also where the next start is tried after a failure of this one */
  PetscCall(error);
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereSolidAngle = {
    EQM_STARTS_SPHERE, "solid-angle",
    "cascade, then equal areas on the sphere itself, balanced with angles; for long limbs", 0, Run};
