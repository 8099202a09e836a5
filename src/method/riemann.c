/* The Riemann map of a disk-type surface by L-BFGS on the boundary's angles: one factorisation, two solves per
   evaluation (docs/methods.md, Riemann map). */
#include "method/riemann.h"
#include "mesh/mesh_private.h"
#include "method/loopgaps.h"
#include "method/loopmetric.h"
#include "method/pairs.h"

typedef struct {
  EqmRiemann riemann;
  EqmLoopMetric metric;
  EqmGaps gaps;
  EqmPairs pairs;
  EqmPlace trial, metric_of; /* metric_of: the map that the metric and the bounds were made for */
  Vec gradient, trial_gradient, direction, unclipped, descent; /* descent: minus the gradient, but for what closes gaps
                                                       at their bounds */
  PetscBool crowded; /* the boundary of the conformal map is beyond the arithmetic */
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

/* The boundary of the first map or that of harmonic measure, whichever has less energy; both centred. Then the first
   evaluation. */
static PetscErrorCode ChooseBoundary(EqmMethod method, EqmIterate iterate)
{
  const EqmProblem problem = method->problem;
  Riemann *const data = method->data;
  const PetscBool has_interior = (PetscBool)(problem->mesh->num_vertices > problem->mesh->num_boundary_vertices);
  PetscReal energy, smallest, of_first;

  PetscFunctionBegin;
  PetscCall(EqmRiemannCentre(problem, data->riemann, &iterate->place));
  PetscCall(EqmRiemannEnergy(problem, data->riemann, &iterate->place, &iterate->objective, data->gradient));
  if (!has_interior) PetscFunctionReturn(0);
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &data->trial));
  PetscCall(EqmRiemannPlaceByMeasure(problem, data->riemann, &data->trial, &data->crowded));
  if (iterate->number > 0) PetscFunctionReturn(0); /* a run that goes on */
  if (!data->crowded) PetscCall(EqmRiemannCentre(problem, data->riemann, &data->trial));
  PetscCall(EqmRiemannSmallestGap(problem, &data->trial, &smallest));
  if (smallest <= EQM_RIEMANN_LEAST_GAP) PetscFunctionReturn(0);
  PetscCall(EqmRiemannSmallestGap(problem, &iterate->place, &of_first));
  PetscCall(EqmRiemannEnergy(problem, data->riemann, &data->trial, &energy, data->trial_gradient));
  if (of_first > EQM_RIEMANN_LEAST_GAP && !(energy < iterate->objective)) PetscFunctionReturn(0);
  PetscCall(EqmPlaceCopy(problem->domain, &data->trial, &iterate->place));
  PetscCall(VecCopy(data->trial_gradient, data->gradient));
  iterate->objective = energy;
  PetscFunctionReturn(0);
}

/* What belongs to the boundary of `place`: its metric, the bounds of its gaps. */
static PetscErrorCode MeasureLoop(Riemann *data, const EqmPlace *place)
{
  const EqmLoop loop = data->riemann->loop;

  PetscFunctionBegin;
  PetscCall(EqmLoopMetricDestroy(&data->metric));
  PetscCall(EqmGapsDestroy(&data->gaps));
  PetscCall(EqmLoopMetricCreate(loop, place->x, &data->metric));
  PetscCall(EqmGapsCreate(loop, place->x, EQM_RIEMANN_LEAST_GAP, &data->gaps));
  PetscFunctionReturn(0);
}

/* The gradient's norm at the present map is that of the descent which closes no gap at its bound. */
static PetscErrorCode FindDescent(EqmMethod method, EqmIterate iterate)
{
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmGapsSet(data->gaps, iterate->place.x));
  PetscCall(VecCopy(data->gradient, data->descent));
  PetscCall(VecScale(data->descent, -1.));
  PetscCall(EqmGapsProject(data->gaps, data->descent));
  PetscCall(VecNorm(data->descent, NORM_2, &iterate->gradient_norm));
  PetscFunctionReturn(0);
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
  PetscCall(VecDuplicate(data->gradient, &data->unclipped));
  PetscCall(VecDuplicate(data->gradient, &data->descent));
  PetscCall(EqmPairsCreate(data->gradient, MEMORY, &data->pairs));
  PetscCall(ChooseBoundary(method, iterate));
  PetscCall(CheckOrder(method, &iterate->place));
  PetscCall(MeasureLoop(data, &iterate->place));
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &data->metric_of));
  PetscCall(FindDescent(method, iterate));
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
  if (EqmStateIsLoading(state)) PetscCall(MeasureLoop(data, &data->metric_of));
  PetscCall(VisitAngles(state, method, "gradient", data->gradient));
  if (EqmStateIsLoading(state)) PetscCall(FindDescent(method, iterate));
  PetscCall(EqmPairsState(data->pairs, state, VisitAngles, method));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&data->metric_of));
  PetscCall(EqmLoopMetricDestroy(&data->metric));
  PetscCall(EqmGapsDestroy(&data->gaps));
  PetscCall(EqmRiemannDestroy(&data->riemann));
  PetscCall(EqmPairsDestroy(&data->pairs));
  PetscCall(EqmPlaceDestroy(&data->trial));
  PetscCall(VecDestroy(&data->gradient));
  PetscCall(VecDestroy(&data->trial_gradient));
  PetscCall(VecDestroy(&data->direction));
  PetscCall(VecDestroy(&data->unclipped));
  PetscCall(VecDestroy(&data->descent));
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

/* Why neighbours on the boundary run together: the surface is long, or with so few triangles the best map of the
   boundary is none. */
static PetscErrorCode DescribeMeeting(EqmMethod method)
{
  const Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(
      method->message,
      data->crowded ? "neighbours on the boundary run together: the surface is so long and narrow, or its mesh so "
                      "fine, in places that its conformal map to the disk has them closer together than a double's "
                      "digits tell apart, whatever the mesh elsewhere; map a part of it, or keep areas (equimap disk)"
                    : "neighbours on the boundary run together: the mesh is too coarse there to keep its angles; "
                      "refine it (equimap convert -refine 2)",
      sizeof(method->message)));
  PetscFunctionReturn(0);
}

/* Armijo by halving, from the longest step that keeps the boundary's order; leaves the trial's map, energy and
   gradient. `t` 0: no decrease. */
static PetscErrorCode Backtrack(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *t, PetscReal *energy)
{
  enum { MOST_TRIALS = 25 };
  const PetscReal shortest_crowded = .01; /* there it is useless to creep on */
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(EqmGapsLongestStep(data->gaps, data->direction, t));
  if (*t < (data->crowded ? shortest_crowded : PETSC_MACHINE_EPSILON)) {
    *t = 0.;
    PetscCall(DescribeMeeting(method));
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

/* Has the boundary run together to a fraction of the polygon that it can span? Where a mesh is so coarse that no map
   keeps its angles tolerably, the energy, which counts the angles' error by area, is least where there is no area. */
static PetscBool IsCollapsing(EqmMethod method, EqmIterate iterate)
{
  const PetscReal least = .25, n = (PetscReal)method->problem->mesh->num_boundary_vertices;

  return (PetscBool)(iterate->totals.total < least * .5 * n * PetscSinReal(2. * PETSC_PI / n));
}

/* The quasi-Newton direction along which no gap closes; where that is none of descent, with gaps that close but are not
   at their bounds; else the steepest descent. */
static PetscErrorCode FindDirection(EqmMethod method, PetscReal *slope)
{
  Riemann *const data = method->data;

  PetscFunctionBegin;
  PetscCall(VecCopy(data->descent, data->direction));
  PetscCall(EqmPairsDirection(data->pairs, ApplyMetric, data, data->direction));
  PetscCall(EqmGapsProject(data->gaps, data->direction));
  PetscCall(VecCopy(data->direction, data->unclipped));
  if (!data->crowded) PetscCall(EqmGapsClip(data->gaps, data->direction));
  PetscCall(VecDot(data->gradient, data->direction, slope));
  if (*slope < 0.) PetscFunctionReturn(0);
  PetscCall(VecCopy(data->unclipped, data->direction));
  PetscCall(VecDot(data->gradient, data->direction, slope));
  if (*slope < 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsForget(data->pairs));
  PetscCall(VecCopy(data->descent, data->direction));
  PetscCall(VecDot(data->gradient, data->direction, slope));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Riemann *const data = method->data;
  PetscReal slope, t, energy;

  PetscFunctionBegin;
  *outcome = EQM_STEP_STALLED;
  if (IsCollapsing(method, iterate)) {
    PetscCall(DescribeMeeting(method));
    PetscFunctionReturn(0);
  }
  PetscCall(FindDirection(method, &slope));
  *outcome = EQM_STEP_CONVERGED;
  if (-slope <= PETSC_MACHINE_EPSILON * PETSC_PI) PetscFunctionReturn(0); /* of energies that are differences of pi */
  *outcome = EQM_STEP_STALLED;
  PetscCall(Backtrack(method, iterate, slope, &t, &energy));
  if (t == 0.) PetscFunctionReturn(0);
  PetscCall(EqmPairsAdd(data->pairs, t, data->direction, data->gradient, data->trial_gradient));
  PetscCall(VecCopy(data->trial_gradient, data->gradient));
  PetscCall(EqmPlaceCopy(method->problem->domain, &data->trial, &iterate->place));
  PetscCall(FindDescent(method, iterate));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  if (IsCollapsing(method, iterate)) PetscCall(VecNorm(data->gradient, NORM_2, &iterate->gradient_norm));
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
