/* The fixed-point iteration of stretch energy minimisation: disk with a moving boundary (000 (14)), square (002
 * Algorithm 1). */
#include "method/fixedpoint.h"
#include "domain/domain_private.h"

typedef enum { STOP_AUTO, STOP_RISE, STOP_STRETCH, STOP_NONE } FixedPointStop;
static const char *const fixed_point_stops[] = {"auto", "rise", "stretch", "none", "EqmFixedPointStop", "EQM_", NULL};

/* The energy, with landmarks the sum of 000 (46). */
static PetscErrorCode TakeObjective(EqmMethod method, EqmIterate iterate)
{
  const EqmLandmarks *const landmarks = &method->problem->landmarks;
  PetscReal squares = 0.;

  PetscFunctionBegin;
  if (landmarks->num_total > 0)
    PetscCall(EqmLandmarksSquares(landmarks, method->problem->domain, iterate->place.x, NULL, &squares));
  iterate->objective = iterate->totals.energy + landmarks->lambda * squares;
  PetscFunctionReturn(0);
}

/* Landmarks are drawn with the boundary held; to a boundary that follows the interior (14b) the paper has no way. */
static PetscErrorCode CheckLandmarks(EqmMethod method)
{
  const EqmProblem problem = method->problem;

  PetscFunctionBegin;
  if (problem->landmarks.num_total > 0 && problem->domain->motion[1] != &EqmMotionHeldOnCircle)
    EqmFail(method->comm, EQM_ERR_USAGE,
            "-method fixed-point draws landmarks on the disk with its boundary held only "
            "(000 section 6); take lm, lbfgs, ncg or rgd");
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(CheckLandmarks(method));
  PetscCall(PetscMalloc4(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &fp->weights, 2 * mesh->num_owned,
                         &fp->columns, 2 * mesh->num_local, &fp->inverted, mesh->num_local, &fp->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) fp->group[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmPlaceCreate(method->problem->domain, &fp->to));
  PetscCall(EqmPlaceCreate(method->problem->domain, &fp->before));
  fp->ended = PETSC_FALSE;
  iterate->gradient_norm = -1.;
  PetscCall(TakeObjective(method, iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(PetscFree4(fp->weights, fp->columns, fp->inverted, fp->group));
  PetscCall(EqmPlaceDestroy(&fp->to));
  PetscCall(EqmPlaceDestroy(&fp->before));
  PetscFunctionReturn(0);
}

/* One pass of the iteration for the domain. */
static PetscErrorCode Pass(EqmMethod method, EqmIterate iterate)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  if (method->problem->domain->curved_image) {
    PetscCall(EqmSphereFixedPointStep(method->problem, iterate, iterate->number, fp->weights));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmLaplacianWeights(method->problem->domain, EQM_LAPLACIAN_STRETCH, &iterate->place, fp->weights));
  if (method->problem->domain->motion[1] == &EqmMotionCircle) {
    PetscCall(EqmFixedPointStepOnDisk(method, iterate));
  } else if (method->problem->landmarks.num_total > 0) {
    PetscCall(EqmFixedPointDraw(method->problem, fp->weights, &iterate->place));
  } else {
    PetscCall(EqmHarmonicMap(method->problem, fp->weights, &iterate->place, &fp->to));
    PetscCall(EqmPlaceCopy(method->problem->domain, &fp->to, &iterate->place));
  }
  PetscFunctionReturn(0);
}

/* E_S of the mesh scaled to the target's measure; the image's may be another. */
static PetscReal Stretch(EqmProblem problem, const EqmImageTotals *totals)
{
  return totals->total * (totals->energy + totals->total) / problem->domain->target_measure;
}

/* 001 Algorithm 2, line 5: the step is the last one if E_S fell by no more than eps. */
static PetscErrorCode JudgeStretch(EqmMethod method, PetscReal fall)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  fp->ended = (PetscBool)(fall <= fp->eps);
  if (fp->ended)
    PetscCall(PetscSNPrintf(method->message, sizeof(method->message),
                            "the stretch energy fell by no more than %.6g in a step", (double)fp->eps));
  PetscFunctionReturn(0);
}

/* Back to the map before the step that raised the energy (001 Table 5). */
static PetscErrorCode TakeBack(EqmMethod method, EqmIterate iterate)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(method->problem->domain, &fp->before, &iterate->place));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  PetscCall(PetscStrncpy(method->message, "the next fixed-point step would raise the energy: there the iteration ends",
                         sizeof(method->message)));
  PetscFunctionReturn(0);
}

/* On the sphere the iteration has no limit to go to: unless it is told otherwise it ends where the energy first rises.
 */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  EqmFixedPoint *const fp = method->data;
  const EqmImageTotals before = iterate->totals;
  const FixedPointStop by_default = method->problem->domain->curved_image ? STOP_RISE : STOP_NONE,
                       stop = (int)fp->stop == STOP_AUTO ? by_default : (FixedPointStop)fp->stop;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (fp->ended) PetscFunctionReturn(0);
  *outcome = EQM_STEP_TAKEN;
  iterate->step_length = 1.;
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &fp->before));
  PetscCall(Pass(method, iterate));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  if (stop == STOP_RISE && !(iterate->totals.energy < before.energy)) {
    PetscCall(TakeBack(method, iterate));
    *outcome = EQM_STEP_CONVERGED;
  } else if (stop == STOP_STRETCH) {
    PetscCall(JudgeStretch(method, Stretch(method->problem, &before) - Stretch(method->problem, &iterate->totals)));
  }
  PetscCall(TakeObjective(method, iterate));
  PetscFunctionReturn(0);
}

/* Nothing but the map goes over from step to step, and whether there is another. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  (void)iterate;
  PetscCall(EqmStateBool(state, "ended", &fp->ended));
  if (EqmStateIsLoading(state) && fp->ended) PetscCall(JudgeStretch(method, 0.)); /* says so again */
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  EqmFixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(
      PetscOptionsEnum("-fixed_point_stop",
                       "fixed-point: where it ends beside -max_it and -energy_rtol: rise, before the energy rises "
                       "(auto: on the sphere); stretch, when the stretch energy has fallen by no more than "
                       "-fixed_point_eps (001 Algorithm 2); none (auto: elsewhere)",
                       "EqmSolverSetFromOptions", fixed_point_stops, fp->stop, &fp->stop, NULL));
  PetscCall(PetscOptionsReal("-fixed_point_eps",
                             "fixed-point: epsilon of 001 Algorithm 2, for a mesh scaled to the target's area",
                             "EqmSolverSetFromOptions", fp->eps, &fp->eps, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateFixedPoint(EqmMethod method)
{
  EqmFixedPoint *fp;

  PetscFunctionBegin;
  PetscCall(PetscNew(&fp));
  fp->eps = 1e-6;
  method->data = fp;
  method->takes_landmarks = PETSC_TRUE;
  method->purpose = "stretch energy minimisation by fixed-point iteration (000 (14), 001 Algorithm 2, 002 Algorithm 1)";
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
