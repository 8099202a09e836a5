/* The two-phase quasi-implicit Euler method (004 Algorithm 5.1). Phase I, (I + dt A) f' = f, forgets a poor start;
   phase II, (I + dt (A - <A f, f>)) f' = f, goes to the harmonic map, and its matrix is indefinite. */
#include "method/flow.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"
#include <string.h>

enum { MOST_ATTEMPTS = 60, MOST_STEPS_IN_PHASE1 = 10, MOST_CUTS = 3, MOST_SHRINKS = 10, MOST_RESTARTS = 20 };
static const PetscReal collapsed = .5, near_enough = .1; /* epsilon 2 and 3 of S1.a and S1.c */

typedef struct {
  EqmGeneral matrix;
  EqmUnknowns unknowns;
  PetscInt phase, steps, cuts, shrinks, restarts;
  PetscReal dt, dt0, most_dt; /* present, first of this attempt, largest of phase II */
  PetscReal energy, change;   /* of the present map, and by the last step; change < 0: no step yet */
  PetscReal factored;         /* phase I: the time step that the factor belongs to */
  PetscBool ended;
  EqmPlace start, trial;
  const PetscReal *weights;
  PetscReal *columns;
} Qiem;

/* 004 Algorithm 5.1, lines 1 to 5, for the surface scaled to the sphere's area, as the formula is no invariant: the
   mean of the middle tenth of the areas to the first power k/3 - 7, k = 1, 2, ..., that is not above 3500. */
static PetscErrorCode FirstTimeStep(EqmSolver solver, PetscReal *dt)
{
  const EqmMesh mesh = solver->mesh;
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

static PetscErrorCode SetUp(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  const EqmSettings *const set = &solver->settings;
  unsigned char *count;
  Qiem *q;

  PetscFunctionBegin;
  PetscCall(PetscNew(&q));
  solver->data = q;
  PetscCall(PetscMalloc1(mesh->num_local, &count));
  for (PetscInt v = 0; v < mesh->num_local; v++) count[v] = 1;
  q->unknowns = (EqmUnknowns){.num_owned = mesh->num_owned, .first = mesh->vertex_start, .start = mesh->global};
  q->unknowns.count = count;
  PetscCall(EqmGeneralCreate(mesh, &q->unknowns, PETSC_TRUE, PETSC_FALSE, &q->matrix));
  PetscCall(EqmPlaceCreate(solver->domain, &q->start));
  PetscCall(EqmPlaceCreate(solver->domain, &q->trial));
  PetscCall(PetscMalloc1(3 * mesh->num_owned, &q->columns));
  PetscCall(EqmAngleWeights(solver, &q->weights));
  PetscCall(FirstTimeStep(solver, &q->most_dt));
  q->dt = q->dt0 = set->flow_step > 0. ? set->flow_step : q->most_dt;
  q->most_dt = PetscMax(q->most_dt, q->dt0);
  q->phase = strcmp(set->qiem_phase1, "none") ? 1 : 2;
  q->change = -1.;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &q->start));
  PetscCall(EqmFlowAccept(solver, &solver->place, 0.));
  q->energy = solver->totals.energy;
  if (!set->quiet) PetscCall(PetscPrintf(solver->comm, "first time step of 004 Algorithm 5.1: %g\n", (double)q->dt0));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Qiem *const q = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmGeneralDestroy(&q->matrix));
  PetscCall(PetscFree(q->unknowns.count));
  PetscCall(EqmPlaceDestroy(&q->start));
  PetscCall(EqmPlaceDestroy(&q->trial));
  PetscCall(PetscFree(q->columns));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* dt times a cell's part of A, in phase II less that of <A f, f>; the identity is added as a shift. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmSolver solver = context;
  const Qiem *const q = solver->data;
  const PetscInt *const v = solver->mesh->cells + 3 * cell;
  const PetscReal *const w = q->weights + 3 * cell, *const x = solver->place.x;

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

/* Phase I keeps its factor for as long as the time step stays: made anew when a run goes on. */
static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Qiem *const q = solver->data;
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
  PetscCall(EqmStatePlace(state, solver->domain, "start", &q->start));
  PetscCall(EqmFlowState(solver, state, &q->dt, &q->ended));
  if (!EqmStateIsLoading(state) || q->phase == 2 || q->factored == 0.) PetscFunctionReturn(0);
  dt = q->dt;
  q->dt = q->factored;
  PetscCall(EqmGeneralFactor(q->matrix, CellMatrix, solver, 1., &success));
  q->dt = dt;
  if (!success) q->factored = 0.;
  PetscFunctionReturn(0);
}

/* One solve with the present time step into the trial; the energy is infinite where the matrix is singular. */
static PetscErrorCode Attempt(EqmSolver solver, PetscReal *energy)
{
  Qiem *const q = solver->data;
  const PetscInt n = solver->mesh->num_owned;
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  *energy = INFINITY;
  if (q->phase == 2 || q->factored != q->dt) PetscCall(EqmGeneralFactor(q->matrix, CellMatrix, solver, 1., &success));
  q->factored = q->phase == 1 ? q->dt : 0.;
  if (!success) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < 3 * n; k++) q->columns[(k % 3) * n + k / 3] = solver->place.x[k];
  PetscCall(EqmGeneralSolve(q->matrix, 3, q->columns));
  for (PetscInt k = 0; k < 3 * n; k++) q->trial.x[k] = q->columns[(k % 3) * n + k / 3];
  PetscCall(EqmFlowNormalise(solver, (PetscBool)(solver->settings.flow_moebius && q->phase == 2), &q->trial));
  PetscCall(EqmFlowEnergy(solver, &q->trial, energy));
  PetscFunctionReturn(0);
}

/* Is the strategy switched on? */
static PetscBool Uses(const char *strategies, char letter)
{
  return (PetscBool)(strchr(strategies, letter) != NULL);
}

/* Back to the first map of the phase, with the given first time step, unless the present one is shorter already. */
static PetscErrorCode Restart(EqmSolver solver, PetscReal dt0)
{
  Qiem *const q = solver->data;

  PetscFunctionBegin;
  q->dt0 = dt0;
  q->dt = PetscMin(q->dt, dt0);
  q->steps = q->cuts = 0;
  q->change = -1.;
  q->restarts++;
  PetscCall(EqmPlaceCopy(solver->domain, &q->start, &solver->place));
  PetscCall(EqmFlowEnergy(solver, &solver->place, &q->energy));
  PetscFunctionReturn(0);
}

/* What to do with a trial: take it, or try again with what has been changed. */
typedef enum { TAKE, AGAIN } Verdict;

/* S1.a: a map that collapses to a point; S1.b: an energy that does not fall. */
static PetscErrorCode JudgePhase1(EqmSolver solver, PetscReal energy, Verdict *verdict)
{
  Qiem *const q = solver->data;
  const char *const strategies = solver->settings.qiem_phase1;

  PetscFunctionBegin;
  *verdict = AGAIN;
  if (Uses(strategies, 'a') && energy < collapsed) {
    PetscCall(Restart(solver, .5 * q->dt));
  } else if (Uses(strategies, 'b') && !(energy <= q->energy) && q->dt > 1.) {
    q->dt = PetscMax(1., .5 * q->dt);
  } else {
    *verdict = TAKE;
  }
  PetscFunctionReturn(0);
}

/* The end of phase I, or S1.c: a fresh beginning when it takes too long, unless it would be the same again. */
static PetscErrorCode AfterPhase1(EqmSolver solver, PetscReal change)
{
  Qiem *const q = solver->data;

  PetscFunctionBegin;
  if (PetscAbsReal(change) < near_enough) {
    q->phase = 2;
    q->dt = q->dt0;
    q->steps = q->restarts = 0;
    q->change = -1.;
    PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &q->start));
  } else if (Uses(solver->settings.qiem_phase1, 'c') && q->steps > MOST_STEPS_IN_PHASE1 && q->dt != q->dt0) {
    PetscCall(Restart(solver, q->dt));
  }
  PetscFunctionReturn(0);
}

/* S2.a: halve the step where the energy rises; S2.b: after three times begin anew with a smaller first step; S2.c: a
   shorter step where the energy changed ten times as much as before, but not for ever: it may hardly have changed then.
 */
static PetscErrorCode JudgePhase2(EqmSolver solver, PetscReal energy, Verdict *verdict)
{
  Qiem *const q = solver->data;
  const EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  *verdict = AGAIN;
  if (Uses(set->qiem_phase2, 'a') && !(energy - q->energy < set->qiem_rise)) {
    q->dt *= .5;
    if (Uses(set->qiem_phase2, 'b') && ++q->cuts >= MOST_CUTS) PetscCall(Restart(solver, q->dt0 / set->qiem_factor));
  } else if (Uses(set->qiem_phase2, 'c') && q->change > 0. && PetscAbsReal(energy - q->energy) >= 10. * q->change &&
             q->shrinks++ < MOST_SHRINKS) {
    q->dt /= set->qiem_factor;
  } else {
    *verdict = TAKE;
  }
  PetscFunctionReturn(0);
}

/* The other half of S2.c: a longer step next time; and the end. */
static PetscErrorCode AfterPhase2(EqmSolver solver, PetscReal change)
{
  Qiem *const q = solver->data;

  PetscFunctionBegin;
  if (Uses(solver->settings.qiem_phase2, 'c') && q->change > 0.)
    q->dt = PetscMin(q->most_dt, q->dt * solver->settings.qiem_factor);
  q->change = PetscAbsReal(change);
  q->cuts = q->shrinks = 0;
  PetscCall(EqmFlowJudge(solver, change, &q->ended));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Qiem *const q = solver->data;
  const PetscInt phase = q->phase;
  PetscReal energy, change, dt;
  Verdict verdict = AGAIN;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (q->ended) PetscFunctionReturn(0);
  *outcome = EQM_STEP_STALLED;
  for (PetscInt attempt = 0; verdict == AGAIN; attempt++) {
    if (attempt == MOST_ATTEMPTS || q->restarts > MOST_RESTARTS) PetscFunctionReturn(0);
    PetscCall(Attempt(solver, &energy));
    PetscCall(phase == 1 ? JudgePhase1(solver, energy, &verdict) : JudgePhase2(solver, energy, &verdict));
  }
  if (!(energy < INFINITY)) PetscFunctionReturn(0);
  dt = q->dt;
  change = energy - q->energy;
  q->energy = energy;
  q->steps++;
  PetscCall(EqmPlaceCopy(solver->domain, &q->trial, &solver->place));
  if (phase == 2) PetscCall(EqmSphereOrient(solver)); /* its matrix may mirror a map, which is as good */
  PetscCall(EqmPlaceMakeFrames(solver->domain, &solver->place));
  PetscCall(phase == 1 ? AfterPhase1(solver, change) : AfterPhase2(solver, change));
  PetscCall(EqmFlowAccept(solver, &solver->place, dt));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

static PetscErrorCode Options(EqmSolver solver, PetscOptionItems *PetscOptionsObject)
{
  EqmSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(EqmFlowOptions(solver, PetscOptionsObject));
  PetscCall(PetscOptionsString(
      "-qiem_phase1", "qiem: which of the strategies S1.a, S1.b, S1.c of 004 phase I uses; none: skip the phase",
      "EqmSolverSetFromOptions", set->qiem_phase1, set->qiem_phase1, sizeof(set->qiem_phase1), NULL));
  PetscCall(PetscOptionsString("-qiem_phase2", "qiem: which of the strategies S2.a, S2.b, S2.c phase II uses",
                               "EqmSolverSetFromOptions", set->qiem_phase2, set->qiem_phase2, sizeof(set->qiem_phase2),
                               NULL));
  PetscCall(PetscOptionsReal("-qiem_factor", "qiem: by which time steps grow and shrink (alpha)",
                             "EqmSolverSetFromOptions", set->qiem_factor, &set->qiem_factor, NULL));
  PetscCall(PetscOptionsReal("-qiem_rise", "qiem: by how much the energy may rise in a step of phase II (epsilon)",
                             "EqmSolverSetFromOptions", set->qiem_rise, &set->qiem_rise, NULL));
  if (set->qiem_factor < 1.)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-qiem_factor %g: give 1 or more", (double)set->qiem_factor);
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodQiem = {
    .name = "qiem",
    .purpose = "two-phase quasi-implicit Euler method (004 Algorithm 5.1): an indefinite factorisation per step",
    .options = Options,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
