/* The Riemann map of a disk-type surface by L-BFGS on the boundary's angles: one factorisation, two solves per
   evaluation (docs/methods.md, Riemann map). */
#include "method/riemann.h"
#include "method/loopmetric.h"
#include "method/pairs.h"

typedef struct {
  EqmRiemann riemann;
  EqmLoopMetric metric;
  EqmPairs pairs;
  EqmPlace trial, metric_of; /* the latter: the map that the metric belongs to */
  Vec gradient, trial_gradient, direction;
} Riemann;

static PetscErrorCode SetUp(EqmSolver solver)
{
  enum { MEMORY = 20 };
  Riemann *data;

  PetscFunctionBegin;
  PetscCall(PetscNew(&data));
  solver->data = data;
  PetscCall(EqmRiemannCreate(solver, &data->riemann));
  PetscCall(EqmPlaceCreate(solver->domain, &data->trial));
  PetscCall(EqmPlaceCreate(solver->domain, &data->metric_of));
  PetscCall(EqmRiemannCreateVec(solver, data->riemann, &data->gradient));
  PetscCall(VecDuplicate(data->gradient, &data->trial_gradient));
  PetscCall(VecDuplicate(data->gradient, &data->direction));
  PetscCall(EqmPairsCreate(data->gradient, MEMORY, &data->pairs));
  PetscCall(EqmRiemannCentre(solver, data->riemann, &solver->place));
  PetscCall(EqmLoopMetricCreate(solver->mesh, data->riemann->num_boundary, data->riemann->boundary, solver->place.x,
                                &data->metric));
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &data->metric_of));
  PetscCall(EqmRiemannEnergy(solver, data->riemann, &solver->place, &solver->objective, data->gradient));
  PetscCall(VecNorm(data->gradient, NORM_2, &solver->gradient_norm));
  PetscCall(EqmSolverLook(solver));
  PetscFunctionReturn(0);
}

/* Boundary angles, as one number per vertex of the mesh. */
static PetscErrorCode VisitAngles(EqmState state, void *context, const char *name, Vec angles)
{
  const EqmSolver solver = context;
  const EqmRiemann riemann = ((Riemann *)solver->data)->riemann;
  PetscReal *local;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(solver->mesh->num_local, &local));
  PetscCall(VecGetArray(angles, &values));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) local[riemann->boundary[b]] = values[b];
  PetscCall(EqmStateVertices(state, name, 1, local));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) values[b] = local[riemann->boundary[b]];
  PetscCall(VecRestoreArray(angles, &values));
  PetscCall(PetscFree(local));
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Riemann *const data = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmStatePlace(state, solver->domain, "metric_of", &data->metric_of));
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmLoopMetricDestroy(&data->metric));
    PetscCall(EqmLoopMetricCreate(solver->mesh, data->riemann->num_boundary, data->riemann->boundary, data->metric_of.x,
                                  &data->metric));
  }
  PetscCall(VisitAngles(state, solver, "gradient", data->gradient));
  PetscCall(EqmPairsState(data->pairs, state, VisitAngles, solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Riemann *const data = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&data->metric_of));
  PetscCall(EqmRiemannDestroy(&data->riemann));
  PetscCall(EqmLoopMetricDestroy(&data->metric));
  PetscCall(EqmPairsDestroy(&data->pairs));
  PetscCall(EqmPlaceDestroy(&data->trial));
  PetscCall(VecDestroy(&data->gradient));
  PetscCall(VecDestroy(&data->trial_gradient));
  PetscCall(VecDestroy(&data->direction));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* q <- S^-1 q: along the angles the energy's Hessian is nearly the Steklov operator, which no conformal map changes. */
static PetscErrorCode ApplyMetric(void *context, Vec q)
{
  const Riemann *const data = context;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArray(q, &values));
  PetscCall(EqmLoopMetricApply(data->metric, values, values));
  PetscCall(VecRestoreArray(q, &values));
  PetscFunctionReturn(0);
}

/* Armijo by halving, from the longest step that keeps the boundary's order; leaves the trial's map, energy and
 * gradient. `t` 0: no decrease. */
static PetscErrorCode Backtrack(EqmSolver solver, PetscReal slope, PetscReal *t, PetscReal *energy)
{
  enum { MOST_TRIALS = 25 };
  Riemann *const data = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmRiemannStepInOrder(solver, data->riemann, &solver->place, data->direction, t));
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscCall(EqmRiemannMove(solver, data->riemann, &solver->place, *t, data->direction, &data->trial));
    PetscCall(EqmRiemannEnergy(solver, data->riemann, &data->trial, energy, data->trial_gradient));
    if (*energy - solver->objective <= 1e-4 * *t * slope) PetscFunctionReturn(0);
    *t *= .5;
  }
  *t = 0.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Riemann *const data = solver->data;
  PetscReal slope, t, energy;

  PetscFunctionBegin;
  PetscCall(VecCopy(data->gradient, data->direction));
  PetscCall(EqmPairsDirection(data->pairs, ApplyMetric, data, data->direction));
  PetscCall(VecScale(data->direction, -1.));
  PetscCall(VecDot(data->gradient, data->direction, &slope));
  *outcome = EQM_STEP_CONVERGED;
  if (-slope <= PETSC_MACHINE_EPSILON * PETSC_PI) PetscFunctionReturn(0); /* of energies that are differences of pi */
  *outcome = EQM_STEP_STALLED;
  PetscCall(Backtrack(solver, slope, &t, &energy));
  if (t == 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsAdd(data->pairs, t, data->direction, data->gradient, data->trial_gradient));
  PetscCall(VecCopy(data->trial_gradient, data->gradient));
  PetscCall(EqmPlaceCopy(solver->domain, &data->trial, &solver->place));
  PetscCall(EqmSolverLook(solver));
  PetscCall(VecNorm(data->gradient, NORM_2, &solver->gradient_norm));
  solver->objective = energy;
  solver->step_length = t;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodRiemann = {
    .name = "riemann",
    .purpose = "Riemann map by the boundary's angles, the interior harmonic: one factorisation",
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
