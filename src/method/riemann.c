/* The Riemann map of a disk-type surface by L-BFGS on the boundary's angles: one factorisation, two solves per
   evaluation (docs/methods.md, Riemann map). */
#include "method/riemann.h"
#include "mesh/mesh_private.h"
#include "method/loopmetric.h"
#include "method/pairs.h"

typedef struct {
  EqmRiemann riemann;
  EqmLoopMetric metric;
  EqmPairs pairs;
  EqmPlace trial, metric_of; /* metric_of: the map that the metric was made for */
  Vec gradient, trial_gradient, direction;
} Riemann;

/* Where angles are so obtuse that harmonic functions leave the disk, there may be no map to begin with. */
static PetscErrorCode CheckOrder(EqmMethod method, const EqmPlace *place)
{
  PetscReal smallest;

  PetscFunctionBegin;
  PetscCall(EqmRiemannSmallestGap(method->problem, place, &smallest));
  if (smallest > EQM_RIEMANN_LEAST_GAP) PetscFunctionReturn(0);
  EqmFail(method->comm, EQM_ERR_MESH,
          "neighbours on the boundary run together as the map begins: the mesh is too coarse, or its triangles are too "
          "obtuse, to keep its angles; refine it (equimap convert -refine 2)");
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  enum { MEMORY = 20 };
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmRiemannCreate(method->problem, &data->riemann));
  PetscCall(EqmPlaceCreate(method->problem->domain, &data->trial));
  PetscCall(EqmPlaceCreate(method->problem->domain, &data->metric_of));
  PetscCall(EqmRiemannCreateVec(method->problem, data->riemann, &data->gradient));
  PetscCall(VecDuplicate(data->gradient, &data->trial_gradient));
  PetscCall(VecDuplicate(data->gradient, &data->direction));
  PetscCall(EqmPairsCreate(data->gradient, MEMORY, &data->pairs));
  PetscCall(EqmRiemannCentre(method->problem, data->riemann, &iterate->place));
  PetscCall(CheckOrder(method, &iterate->place));
  PetscCall(EqmLoopMetricCreate(method->problem->mesh, data->riemann->num_boundary, data->riemann->boundary,
                                iterate->place.x, &data->metric));
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &data->metric_of));
  PetscCall(EqmRiemannEnergy(method->problem, data->riemann, &iterate->place, &iterate->objective, data->gradient));
  PetscCall(VecNorm(data->gradient, NORM_2, &iterate->gradient_norm));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  PetscFunctionReturn(0);
}

/* Boundary angles, as one number per vertex of the mesh. */
static PetscErrorCode VisitAngles(EqmState state, void *context, const char *name, Vec angles)
{
  const EqmMethod method = context;
  const EqmRiemann riemann = ((Riemann *)method->data)->riemann;
  PetscReal *local;
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(method->problem->mesh->num_local, &local));
  PetscCall(VecGetArray(angles, &values));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) local[riemann->boundary[b]] = values[b];
  PetscCall(EqmStateVertices(state, name, 1, local));
  for (PetscInt b = 0; b < riemann->num_boundary; b++) values[b] = local[riemann->boundary[b]];
  PetscCall(VecRestoreArray(angles, &values));
  PetscCall(PetscFree(local));
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmStatePlace(state, method->problem->domain, "metric_of", &data->metric_of));
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmLoopMetricDestroy(&data->metric));
    PetscCall(EqmLoopMetricCreate(method->problem->mesh, data->riemann->num_boundary, data->riemann->boundary,
                                  data->metric_of.x, &data->metric));
  }
  PetscCall(VisitAngles(state, method, "gradient", data->gradient));
  PetscCall(EqmPairsState(data->pairs, state, VisitAngles, method));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&data->metric_of));
  PetscCall(EqmRiemannDestroy(&data->riemann));
  PetscCall(EqmLoopMetricDestroy(&data->metric));
  PetscCall(EqmPairsDestroy(&data->pairs));
  PetscCall(EqmPlaceDestroy(&data->trial));
  PetscCall(VecDestroy(&data->gradient));
  PetscCall(VecDestroy(&data->trial_gradient));
  PetscCall(VecDestroy(&data->direction));
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
   gradient. `t` 0: no decrease. */
static PetscErrorCode Backtrack(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *t, PetscReal *energy)
{
  enum { MOST_TRIALS = 25 };
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmRiemannStepInOrder(method->problem, data->riemann, &iterate->place, data->direction, t));
  if (*t < PETSC_MACHINE_EPSILON) { /* with so few triangles the best map of the boundary is none */
    *t = 0.;
    PetscCall(PetscStrncpy(method->message,
                           "neighbours on the boundary run together: the mesh is too coarse there to keep its angles; "
                           "refine it (equimap convert -refine 2)",
                           sizeof(method->message)));
  }
  for (PetscInt trial = 0; trial<MOST_TRIALS && * t> 0.; trial++) {
    PetscCall(EqmRiemannMove(method->problem, data->riemann, &iterate->place, *t, data->direction, &data->trial));
    PetscCall(EqmRiemannEnergy(method->problem, data->riemann, &data->trial, energy, data->trial_gradient));
    if (*energy - iterate->objective <= 1e-4 * *t * slope) PetscFunctionReturn(0);
    *t *= .5;
  }
  *t = 0.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Riemann *const data = method->data;
  PetscReal slope, t, energy;

  PetscFunctionBegin;
  PetscCall(VecCopy(data->gradient, data->direction));
  PetscCall(EqmPairsDirection(data->pairs, ApplyMetric, data, data->direction));
  PetscCall(VecScale(data->direction, -1.));
  PetscCall(VecDot(data->gradient, data->direction, &slope));
  *outcome = EQM_STEP_CONVERGED;
  if (-slope <= PETSC_MACHINE_EPSILON * PETSC_PI) PetscFunctionReturn(0); /* of energies that are differences of pi */
  *outcome = EQM_STEP_STALLED;
  PetscCall(Backtrack(method, iterate, slope, &t, &energy));
  if (t == 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsAdd(data->pairs, t, data->direction, data->gradient, data->trial_gradient));
  PetscCall(VecCopy(data->trial_gradient, data->gradient));
  PetscCall(EqmPlaceCopy(method->problem->domain, &data->trial, &iterate->place));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  PetscCall(VecNorm(data->gradient, NORM_2, &iterate->gradient_norm));
  iterate->objective = energy;
  iterate->step_length = t;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateRiemann(EqmMethod method)
{
  Riemann *data;

  PetscFunctionBegin;
  PetscCall(PetscNew(&data));
  method->data = data;
  method->purpose = "Riemann map by the boundary's angles, the interior harmonic: one factorisation";
  method->ops = (EqmMethodOps){.set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
