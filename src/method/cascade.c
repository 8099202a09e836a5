/* The cascade alone (docs/methods.md, Cascade): from the start of that name, relaxation of the mesh itself. One
   iteration is a Gauss-Newton step of areas with a little of the angles, ever less, solved roughly by multigrid on the
   hierarchy, and two Gauss-Seidel sweeps over the vertices. No matrix is factored but a small one. With a tolerance
   of the run's own it goes on to this. */
#include "method/method.h"
#include "domain/domain_private.h"
#include "problem/levels.h"

/* Weights of the angle energy, at first and at last; and when another iteration is not worth its time. */
static const PetscReal first_epsilon = .01, last_epsilon = 1e-3, least_gain = .03;
/* The same where the run is to go on: every iteration has a tenth of the one before down to the former, then only where
   one has gained little, down to the latter, beside which rounding counts. */
static const PetscReal soon_epsilon = 1e-4, least_epsilon = 1e-8;
enum {
  MOST_USES = 4 /* relaxations in a row whose multigrid has the prolongations of one map */
};

typedef struct {
  EqmLevels *levels; /* the problem's */
  EqmRelaxer relaxer;
  EqmPlace image_of; /* the map that multigrid's prolongations are at */
  PetscInt image_uses;
  EqmCascadeOptions options;
  PetscReal epsilon; /* zero: the end */
} Cascade;

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  Cascade *const cascade = method->data;
  const char *const obstacle = EqmLevelsObstacle(method->problem);

  PetscFunctionBegin;
  if (obstacle) EqmFail(method->comm, EQM_ERR_USAGE, "-method cascade %s; take the default method", obstacle);
  if (iterate->totals.folds > 0)
    EqmFail(method->comm, EQM_ERR_USAGE,
            "-method cascade needs a start without folds, and this one has %" PetscInt64_FMT
            "; take -start cascade, or another start or a better mesh",
            iterate->totals.folds);
  PetscCall(EqmCascadeOptionsDefault(&cascade->options));
  cascade->epsilon = first_epsilon;
  cascade->options.sweeps = 0; /* those after the step do for the next, too */
  cascade->options.least_gain = 0.;
  PetscCall(EqmProblemGetLevels(method->problem, &cascade->levels));
  PetscCall(EqmLevelsCreateRelaxer(cascade->levels, &cascade->relaxer));
  PetscCall(EqmPlaceCreate(method->problem->domain, &cascade->image_of));
  cascade->image_uses = 0;
  iterate->objective = iterate->totals.energy;
  iterate->gradient_norm = -1.;
  PetscFunctionReturn(0);
}

/* Prolongations at the present map, if those at hand have served long enough. */
static PetscErrorCode PrepareImage(Cascade *cascade, EqmProblem problem, const EqmIterate iterate)
{
  PetscFunctionBegin;
  if (cascade->image_uses % MOST_USES == 0) {
    cascade->image_uses = 0;
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &cascade->image_of));
    PetscCall(EqmRelaxerSetImage(cascade->relaxer, &cascade->options, cascade->image_of.x));
  }
  cascade->image_uses++;
  PetscFunctionReturn(0);
}

/* Are areas no further from equal than before, or than a smooth map may have them? In strips and limbs that are far
   longer than wide shear outweighs them, until its weight has fallen. */
static PetscBool KeepsAreas(const EqmCascadeResult *result, const EqmImageTotals *before)
{
  const PetscReal close = 1e-3;

  return (PetscBool)(result->energy <= PetscMax(before->energy, close * before->total));
}

/* The map after one relaxation, if it is better and has no folds; `gained`: by enough. */
static PetscErrorCode Relax(Cascade *cascade, EqmProblem problem, EqmIterate iterate, PetscBool *better,
                            PetscBool *gained)
{
  EqmLevels *const levels = cascade->levels;
  EqmCascadeResult result;
  EqmPlace trial;
  PetscInt64 folds;

  PetscFunctionBegin;
  cascade->options.epsilon_finest = cascade->epsilon;
  PetscCall(EqmPlaceCreate(problem->domain, &trial));
  PetscCall(PrepareImage(cascade, problem, iterate));
  PetscCall(EqmLevelsRelax(levels, cascade->relaxer, &cascade->options, &iterate->place, &trial, &result));
  PetscCall(EqmPlaceMakeFrames(problem->domain, &trial));
  PetscCall(EqmImageFolds(problem->domain, &trial, iterate->image, &folds));
  PetscCall(EqmDomainBoundaryInOrder(problem->domain, &trial, better));
  *better =
      (PetscBool)(*better && folds == 0 && result.objective < result.before && KeepsAreas(&result, &iterate->totals));
  *gained = (PetscBool)(*better && result.objective < (1. - least_gain) * result.before);
  if (*better) PetscCall(EqmPlaceCopy(problem->domain, &trial, &iterate->place));
  PetscCall(EqmPlaceDestroy(&trial));
  PetscFunctionReturn(0);
}

/* Zero: the end. */
static PetscReal NextEpsilon(EqmMethod method, PetscReal epsilon, PetscBool gained)
{
  const PetscReal soon = method->goes_on ? soon_epsilon : last_epsilon, last = method->goes_on ? least_epsilon : soon;

  if (epsilon > soon) return PetscMax(.1 * epsilon, soon);
  if (gained) return epsilon;
  return epsilon > last ? PetscMax(.1 * epsilon, last) : 0.;
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Cascade *const cascade = method->data;
  PetscBool better = PETSC_FALSE;

  PetscFunctionBegin;
  while (!better && cascade->epsilon > 0.) {
    PetscBool gained;
    PetscCall(Relax(cascade, method->problem, iterate, &better, &gained));
    cascade->epsilon = NextEpsilon(method, cascade->epsilon, gained);
  }
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  iterate->objective = iterate->totals.energy;
  iterate->step_length = 1.;
  *outcome = better ? EQM_STEP_TAKEN : EQM_STEP_CONVERGED;
  if (!better)
    PetscCall(PetscStrncpy(method->message, "another relaxation would gain less than three hundredths",
                           sizeof(method->message)));
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Cascade *const cascade = method->data;

  PetscFunctionBegin;
  (void)iterate;
  PetscCall(EqmStateReal(state, "angle_weight", &cascade->epsilon));
  PetscCall(EqmStateInt(state, "image_uses", &cascade->image_uses));
  if (cascade->image_uses == 0) PetscFunctionReturn(0);
  PetscCall(EqmStatePlace(state, method->problem->domain, "image_of", &cascade->image_of));
  if (EqmStateIsLoading(state)) PetscCall(EqmRelaxerSetImage(cascade->relaxer, &cascade->options, cascade->image_of.x));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Cascade *const cascade = method->data;

  PetscFunctionBegin;
  PetscCall(EqmRelaxerDestroy(&cascade->relaxer));
  if (cascade->image_of.x) PetscCall(EqmPlaceDestroy(&cascade->image_of));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateCascade(EqmMethod method)
{
  Cascade *cascade;

  PetscFunctionBegin;
  PetscCall(PetscNew(&cascade));
  method->data = cascade;
  method->purpose = "relaxation on a hierarchy of coarser meshes: a smooth map, areas good to a percent or two, soon";
  method->ops = (EqmMethodOps){.set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
