/* The implicit Euler method (004 (8), (9), Appendix): each step solves a nonlinear system that couples the coordinates,
   by Newton's method. */
#include "method/flow.h"
#include "geometry/simplex.h"

typedef struct {
  EqmGeneral matrix;
  EqmUnknowns unknowns;
  PetscInt *start;
  EqmImplicitStep step;
  PetscReal dt;
  PetscBool ended;
  EqmPlace trial;
  PetscReal *residual;
} Implicit;

/* Shortest time step that is tried. */
#define SHORTEST 1e-6

PetscErrorCode EqmImplicitResidual(const EqmImplicitStep *step, const EqmPlace *from, PetscReal *residual)
{
  const EqmSolver solver = step->solver;
  const PetscInt n = solver->mesh->num_owned;
  PetscReal *normal;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &normal));
  PetscCall(EqmFlowLaplacian(solver, step->place, residual, normal));
  for (PetscInt k = 0; k < 3 * n; k++) {
    const PetscReal x = step->place->x[k];
    residual[k] = x - from->x[k] + step->dt * (residual[k] - normal[k / 3] * x);
  }
  PetscCall(PetscFree(normal));
  PetscFunctionReturn(0);
}

void EqmImplicitCell(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmImplicitStep *const step = context;
  const PetscInt *const v = step->solver->mesh->cells + 3 * cell;
  const PetscReal *const w = step->weights + 3 * cell, *const x = step->place->x;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscInt b = (a + 1) % 3, c = (a + 2) % 3;
    const PetscReal *const p = x + 3 * v[a], row[3] = {w[b] + w[c], -w[c], -w[b]};
    PetscReal af[3];
    for (PetscInt k = 0; k < 3; k++) af[k] = w[c] * (p[k] - x[3 * v[b] + k]) + w[b] * (p[k] - x[3 * v[c] + k]);
    const PetscReal normal = EqmDot3(af, p);
    for (PetscInt k = 0; k < 9; k++) { /* coordinate k / 3 of corner a by coordinate k % 3 of each corner */
      const PetscInt i = k / 3, j = k % 3;
      const PetscReal across = (i == j ? 1. : 0.) - p[i] * p[j];
      for (PetscInt d = 0; d < 3; d++) matrix[9 * (3 * a + i) + 3 * ((a + d) % 3) + j] = step->dt * row[d] * across;
      matrix[9 * (3 * a + i) + 3 * a + j] -= step->dt * (p[i] * af[j] + (i == j ? normal : 0.));
    }
  }
}

static PetscErrorCode SetUp(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  unsigned char *count;
  Implicit *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  solver->data = s;
  PetscCall(PetscMalloc1(mesh->num_local, &count));
  PetscCall(PetscMalloc1(mesh->num_local, &s->start));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    count[v] = 3;
    s->start[v] = 3 * mesh->global[v];
  }
  s->unknowns = (EqmUnknowns){3 * mesh->num_owned, 3 * mesh->vertex_start, s->start, count};
  PetscCall(EqmGeneralCreate(mesh, &s->unknowns, PETSC_FALSE, PETSC_TRUE, &s->matrix));
  PetscCall(EqmPlaceCreate(solver->domain, &s->trial));
  PetscCall(PetscMalloc1(6 * mesh->num_owned, &s->residual)); /* and room for it in columns */
  s->dt = solver->settings.flow_step > 0. ? solver->settings.flow_step : 5.;
  s->step = (EqmImplicitStep){.solver = solver, .place = &s->trial};
  PetscCall(EqmAngleWeights(solver, &s->step.weights));
  PetscCall(EqmFlowAccept(solver, &solver->place, 0.));
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Implicit *const s = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmFlowState(solver, state, &s->dt, &s->ended));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Implicit *const s = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmGeneralDestroy(&s->matrix));
  PetscCall(PetscFree(s->unknowns.count));
  PetscCall(PetscFree(s->start));
  PetscCall(EqmPlaceDestroy(&s->trial));
  PetscCall(PetscFree(s->residual));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* Residual at the trial and its norm. */
static PetscErrorCode Evaluate(EqmSolver solver, PetscReal *norm)
{
  Implicit *const s = solver->data;
  PetscReal sum = 0.;

  PetscFunctionBegin;
  PetscCall(EqmImplicitResidual(&s->step, &solver->place, s->residual));
  for (PetscInt k = 0; k < 3 * solver->mesh->num_owned; k++) sum += PetscSqr(s->residual[k]);
  PetscCall(MPIU_Allreduce(&sum, norm, 1, MPIU_REAL, MPIU_SUM, solver->comm));
  *norm = PetscSqrtReal(*norm);
  PetscFunctionReturn(0);
}

/* Newton's method from the present map (004 (9)) with the present time step; the trial is its result. */
static PetscErrorCode Newton(EqmSolver solver, PetscBool *success, PetscInt *iterations)
{
  enum { MOST_ITERATIONS = 12 };
  Implicit *const s = solver->data;
  const PetscReal small = 1e-11 * PetscSqrtReal((PetscReal)solver->mesh->num_vertices);
  PetscReal norm, first;

  PetscFunctionBegin;
  s->step.dt = s->dt;
  *success = PETSC_TRUE;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &s->trial));
  PetscCall(Evaluate(solver, &first));
  norm = first;
  for (*iterations = 0; norm > small && *success; (*iterations)++) {
    PetscCall(EqmGeneralFactor(s->matrix, EqmImplicitCell, &s->step, 1., success));
    if (!*success) break;
    PetscCall(EqmGeneralSolve(s->matrix, 1, s->residual));
    for (PetscInt k = 0; k < 3 * solver->mesh->num_owned; k++) s->trial.x[k] -= s->residual[k];
    PetscCall(EqmMeshUpdateGhosts(solver->mesh, 3, s->trial.x));
    PetscCall(Evaluate(solver, &norm));
    *success = (PetscBool)(norm <= 10. * first && *iterations < MOST_ITERATIONS);
  }
  PetscFunctionReturn(0);
}

/* A step whose system Newton's method does not solve, or after which the energy is higher, is halved; one that took few
   iterations is followed by a longer one. */
static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  enum { FEW = 4 };
  Implicit *const s = solver->data;
  const PetscReal before = solver->totals.energy;
  PetscReal energy = INFINITY, dt = s->dt;
  PetscInt iterations = 0;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (s->ended) PetscFunctionReturn(0);
  *outcome = EQM_STEP_STALLED;
  while (!(energy <= before + solver->settings.flow_tol)) {
    PetscBool success;
    if (s->dt < SHORTEST) PetscFunctionReturn(0);
    dt = s->dt;
    PetscCall(Newton(solver, &success, &iterations));
    if (success) {
      PetscCall(EqmFlowNormalise(solver, solver->settings.flow_moebius, &s->trial));
      PetscCall(EqmFlowEnergy(solver, &s->trial, &energy));
    }
    s->dt *= .5;
  }
  s->dt = iterations <= FEW ? 1.5 * dt : dt;
  PetscCall(EqmFlowAccept(solver, &s->trial, dt));
  PetscCall(EqmFlowJudge(solver, energy - before, &s->ended));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodEulerImplicit = {
    .name = "euler-implicit",
    .purpose = "implicit Euler method (004 (8)): Newton's method on the coupled system in each step",
    .options = EqmFlowOptions,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
