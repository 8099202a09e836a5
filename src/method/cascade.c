/* The cascade alone (docs/methods.md, Cascade): from the start of that name, relaxation of the mesh itself. One
   iteration is some Gauss-Seidel sweeps over the vertices, a Gauss-Newton step of areas with a little of the angles,
   solved to a tenth by multigrid on the hierarchy, and two sweeps more. No matrix is factored but a small one. */
#include "method/method.h"
#include "domain/domain_private.h"
#include "problem/levels.h"

/* Weight of the angle energy; and when another iteration is not worth its time. */
static const PetscReal epsilon = .01, least_gain = .05;
enum { SWEEPS = 2 };

typedef struct {
  EqmLevels levels;
  EqmCascadeOptions options;
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
  cascade->options.epsilon_finest = epsilon;
  cascade->options.sweeps = SWEEPS;
  PetscCall(EqmLevelsCreate(method->problem, &cascade->levels));
  iterate->objective = iterate->totals.energy;
  iterate->gradient_norm = -1.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Cascade *const cascade = method->data;
  EqmLevels *const levels = &cascade->levels;
  EqmCascadeResult result;
  EqmPlace trial;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(EqmLevelsGather(levels, &iterate->place));
  PetscCall(EqmCascadeRelax(levels->hierarchy, levels->target, &cascade->options, levels->x, &result));
  PetscCall(EqmPlaceCreate(method->problem->domain, &trial));
  PetscCall(EqmLevelsScatter(levels, &trial));
  PetscCall(EqmPlaceMakeFrames(method->problem->domain, &trial));
  PetscCall(EqmImageFolds(method->problem->domain, &trial, iterate->image, &folds));
  *outcome = EQM_STEP_CONVERGED;
  if (folds == 0 && result.objective < (1. - least_gain) * result.before) *outcome = EQM_STEP_TAKEN;
  if (*outcome == EQM_STEP_TAKEN) PetscCall(EqmPlaceCopy(method->problem->domain, &trial, &iterate->place));
  PetscCall(EqmPlaceDestroy(&trial));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  iterate->objective = iterate->totals.energy;
  iterate->step_length = 1.;
  if (*outcome == EQM_STEP_CONVERGED)
    PetscCall(
        PetscStrncpy(method->message, "another relaxation would gain less than a twentieth", sizeof(method->message)));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelsDestroy(&((Cascade *)method->data)->levels));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateCascade(EqmMethod method)
{
  Cascade *cascade;

  PetscFunctionBegin;
  PetscCall(PetscNew(&cascade));
  method->data = cascade;
  method->purpose = "relaxation on a hierarchy of coarser meshes: a smooth map, areas good to a few percent, soon";
  method->ops = (EqmMethodOps){.set_up = SetUp, .step = Step, .reset = Reset};
  PetscFunctionReturn(0);
}
