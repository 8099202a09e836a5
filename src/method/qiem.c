/* The two-phase quasi-implicit Euler method (004 Algorithm 5.1). Phase I, (I + dt A) f' = f, damps a poor first map;
   phase II, (I + dt (A - <A f, f>)) f' = f, converges to the harmonic map; its matrix is indefinite. */
#include "method/qiem.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"
#include <string.h>

enum { MOST_ATTEMPTS = 60, MOST_RESTARTS = 20 };

/* 004 Algorithm 5.1, lines 1 to 5, for the surface scaled to the sphere's area, as the formula is no invariant: the
   mean of the middle tenth of the areas to the first power k/3 - 7, k = 1, 2, ..., that is not above 3500. */
static PetscErrorCode FirstTimeStep(EqmMethod method, EqmIterate iterate, PetscReal *dt)
{
  const EqmMesh mesh = method->problem->mesh;
  PetscReal *area, mean, power = -7.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned_cells, &area));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) area[c] = 4. * PETSC_PI * mesh->weight[c];
  PetscCall(EqmMeanBetween(mesh->comm, mesh->num_owned_cells, area, .45, .55, &mean));
  PetscCall(PetscFree(area));
  do power += 1. / 3.;
  while (power < 0. && PetscPowReal(mean, power) > 3500.);
  *dt = PetscPowReal(mean, power);
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  EqmQiem *const q = method->data;
  unsigned char *count;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &count));
  for (PetscInt v = 0; v < mesh->num_local; v++) count[v] = 1;
  q->unknowns = (EqmUnknowns){.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};
  q->unknowns.count = count;
  PetscCall(EqmGeneralCreate(mesh, &q->unknowns, PETSC_TRUE, PETSC_FALSE, &q->matrix));
  PetscCall(EqmPlaceCreate(method->problem->domain, &q->start));
  PetscCall(EqmPlaceCreate(method->problem->domain, &q->trial));
  PetscCall(PetscMalloc1(3 * mesh->num_owned, &q->columns));
  PetscCall(EqmProblemGetAngleWeights(method->problem, &q->weights));
  PetscCall(FirstTimeStep(method, iterate, &q->most_dt));
  q->dt = q->dt0 = q->flow.step > 0. ? q->flow.step : q->most_dt;
  q->most_dt = PetscMax(q->most_dt, q->dt0);
  q->phase = strcmp(q->phase1, "none") ? 1 : 2;
  q->change = -1.;
  q->steps = q->cuts = q->shrinks = q->restarts = 0;
  q->factored = 0.;
  q->ended = PETSC_FALSE;
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &q->start));
  PetscCall(EqmFlowAccept(method->problem, iterate, &iterate->place, 0.));
  q->energy = iterate->totals.energy;
  PetscCall(EqmProblemNotify(method->problem, "first time step of 004 Algorithm 5.1: %.6g\n", (double)q->dt0));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  PetscCall(EqmGeneralDestroy(&q->matrix));
  PetscCall(PetscFree(q->unknowns.count));
  PetscCall(EqmPlaceDestroy(&q->start));
  PetscCall(EqmPlaceDestroy(&q->trial));
  PetscCall(PetscFree(q->columns));
  PetscFunctionReturn(0);
}

/* dt times a cell's part of A, in phase II less that of <A f, f>; the identity is added as a shift. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmMethod method = context;
  const EqmIterate iterate = method->iterate;
  const EqmQiem *const q = method->data;
  const PetscInt *const v = method->problem->mesh->cells + 3 * cell;
  const PetscReal *const w = q->weights + 3 * cell, *const x = iterate->place.x;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscInt b = (a + 1) % 3, c = (a + 2) % 3; /* the edge from a to b lies opposite to c */
    matrix[4 * a] = q->dt * (w[b] + w[c]);
    matrix[3 * a + b] = -q->dt * w[c];
    matrix[3 * a + c] = -q->dt * w[b];
    for (PetscInt k = 0; k < 3 && q->phase == 2; k++) {
      const PetscReal p = x[3 * v[a] + k];
      matrix[4 * a] -= q->dt * p * (w[c] * (p - x[3 * v[b] + k]) + w[b] * (p - x[3 * v[c] + k]));
    }
  }
}

/* Phase I reuses its factor while the time step stays the same; a restarted run factors again. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  EqmQiem *const q = method->data;
  PetscInt *const counts[] = {&q->phase, &q->steps, &q->cuts, &q->shrinks, &q->restarts};
  static const char *const names[] = {"phase", "steps", "cuts", "shrinks", "restarts"};
  PetscReal dt;
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  for (size_t k = 0; k < sizeof(counts) / sizeof(counts[0]); k++) PetscCall(EqmStateInt(state, names[k], counts[k]));
  PetscCall(EqmStateReal(state, "first_time_step", &q->dt0));
  PetscCall(EqmStateReal(state, "longest_time_step", &q->most_dt));
  PetscCall(EqmStateReal(state, "energy", &q->energy));
  PetscCall(EqmStateReal(state, "change", &q->change));
  PetscCall(EqmStateReal(state, "factored_for", &q->factored));
  PetscCall(EqmStatePlace(state, method->problem->domain, "start", &q->start));
  PetscCall(EqmFlowState(method, state, &q->dt, &q->ended));
  if (!EqmStateIsLoading(state) || q->phase == 2 || q->factored == 0.) PetscFunctionReturn(0);
  dt = q->dt;
  q->dt = q->factored;
  PetscCall(EqmGeneralFactor(q->matrix, CellMatrix, method, 1., &success));
  q->dt = dt;
  if (!success) q->factored = 0.;
  PetscFunctionReturn(0);
}

/* One solve with the present time step into the trial; the energy is infinite where the matrix is singular. */
static PetscErrorCode Attempt(EqmMethod method, EqmIterate iterate, PetscReal *energy)
{
  EqmQiem *const q = method->data;
  const PetscInt n = method->problem->mesh->num_owned;
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  *energy = INFINITY;
  if (q->phase == 2 || q->factored != q->dt) PetscCall(EqmGeneralFactor(q->matrix, CellMatrix, method, 1., &success));
  q->factored = q->phase == 1 ? q->dt : 0.;
  if (!success) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < 3 * n; k++) q->columns[(k % 3) * n + k / 3] = iterate->place.x[k];
  PetscCall(EqmGeneralSolve(q->matrix, 3, q->columns));
  for (PetscInt k = 0; k < 3 * n; k++) q->trial.x[k] = q->columns[(k % 3) * n + k / 3];
  PetscCall(EqmFlowNormalise(method->problem, (PetscBool)(q->flow.moebius && q->phase == 2), &q->trial));
  PetscCall(EqmFlowEnergy(method->problem, &q->trial, energy));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  EqmQiem *const q = method->data;
  const PetscInt phase = q->phase;
  PetscReal energy, change, dt;
  EqmQiemVerdict verdict = EQM_QIEM_AGAIN;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (q->ended) PetscFunctionReturn(0);
  *outcome = EQM_STEP_STALLED;
  for (PetscInt attempt = 0; verdict == EQM_QIEM_AGAIN; attempt++) {
    if (attempt == MOST_ATTEMPTS || q->restarts > MOST_RESTARTS) PetscFunctionReturn(0);
    PetscCall(Attempt(method, iterate, &energy));
    PetscCall(phase == 1 ? EqmQiemJudgePhase1(method, iterate, energy, &verdict)
                         : EqmQiemJudgePhase2(method, iterate, energy, &verdict));
  }
  if (!(energy < INFINITY)) PetscFunctionReturn(0);
  dt = q->dt;
  change = energy - q->energy;
  q->energy = energy;
  q->steps++;
  const EqmPlace before = iterate->place;
  iterate->place = q->trial;
  q->trial = before;
  if (phase == 2)
    PetscCall(EqmSphereOrient(method->problem,
                              iterate)); /* the indefinite matrix may mirror the map, which has the same energy */
  PetscCall(EqmPlaceMakeFrames(method->problem->domain, &iterate->place));
  PetscCall(EqmFlowChange(method->problem, &q->trial, &iterate->place, &iterate->figures.change));
  iterate->figures.phase = phase;
  PetscCall(phase == 1 ? EqmQiemAfterPhase1(method, iterate, change) : EqmQiemAfterPhase2(method, iterate, change));
  PetscCall(EqmFlowAccept(method->problem, iterate, &iterate->place, dt));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  EqmQiem *const q = method->data;

  PetscFunctionBegin;
  PetscCall(EqmFlowSetFromOptions(method, PetscOptionsObject));
  PetscCall(
      PetscOptionsString("-qiem_phase1",
                         "qiem: which of the strategies S1.a, S1.b, S1.c of 004 phase I uses; none: skip the phase",
                         "EqmSolverSetFromOptions", q->phase1, q->phase1, sizeof(q->phase1), NULL));
  PetscCall(PetscOptionsString("-qiem_phase2", "qiem: which of the strategies S2.a, S2.b, S2.c phase II uses",
                               "EqmSolverSetFromOptions", q->phase2, q->phase2, sizeof(q->phase2), NULL));
  PetscCall(PetscOptionsReal("-qiem_factor", "qiem: by which time steps grow and shrink (alpha)",
                             "EqmSolverSetFromOptions", q->factor, &q->factor, NULL));
  PetscCall(PetscOptionsReal("-qiem_rise", "qiem: by how much the energy may rise in a step of phase II (epsilon)",
                             "EqmSolverSetFromOptions", q->rise, &q->rise, NULL));
  if (q->factor < 1.) EqmFail(method->comm, EQM_ERR_USAGE, "-qiem_factor %.6g: give 1 or more", (double)q->factor);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateQiem(EqmMethod method)
{
  EqmQiem *q;

  PetscFunctionBegin;
  PetscCall(PetscNew(&q));
  q->flow.tol = EQM_FLOW_TOL;
  q->factor = 1.05;
  q->rise = .05;
  PetscCall(PetscStrncpy(q->phase1, "abc", sizeof(q->phase1)));
  PetscCall(PetscStrncpy(q->phase2, "abc", sizeof(q->phase2)));
  method->data = q;
  method->purpose = "two-phase quasi-implicit Euler method (004 Algorithm 5.1): an indefinite factorisation per step";
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
