/* The implicit Euler method (004 (8), (9), Appendix): each step solves a nonlinear system that couples the coordinates,
   by Newton's method. */
#include "method/flow.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

typedef struct {
  EqmFlowSettings flow;
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
  const EqmProblem problem = step->problem;
  const PetscInt n = problem->mesh->num_owned;
  PetscReal *normal;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &normal));
  PetscCall(EqmFlowLaplacian(problem, step->place, residual, normal));
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
  const PetscInt *const v = step->problem->mesh->cells + 3 * cell;
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

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  unsigned char *count;
  Implicit *const s = method->data;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &count));
  PetscCall(PetscMalloc1(mesh->num_local, &s->start));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    count[v] = 3;
    s->start[v] = 3 * mesh->global[v];
  }
  s->unknowns = (EqmUnknowns){3 * mesh->num_owned, 3 * mesh->vertex_start, s->start, count};
  PetscCall(EqmGeneralCreate(mesh, &s->unknowns, PETSC_FALSE, PETSC_TRUE, &s->matrix));
  PetscCall(EqmPlaceCreate(method->problem->domain, &s->trial));
  PetscCall(PetscMalloc1(6 * mesh->num_owned, &s->residual)); /* and the same in columns */
  s->dt = s->flow.step > 0. ? s->flow.step : 5.;
  s->step = (EqmImplicitStep){.problem = method->problem, .place = &s->trial};
  PetscCall(EqmProblemGetAngleWeights(method->problem, &s->step.weights));
  s->ended = PETSC_FALSE;
  PetscCall(EqmFlowAccept(method->problem, iterate, &iterate->place, 0.));
  PetscFunctionReturn(0);
}

static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Implicit *const s = method->data;

  PetscFunctionBegin;
  PetscCall(EqmFlowState(method, state, &s->dt, &s->ended));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Implicit *const s = method->data;

  PetscFunctionBegin;
  PetscCall(EqmGeneralDestroy(&s->matrix));
  PetscCall(PetscFree(s->unknowns.count));
  PetscCall(PetscFree(s->start));
  PetscCall(EqmPlaceDestroy(&s->trial));
  PetscCall(PetscFree(s->residual));
  PetscFunctionReturn(0);
}

/* Residual at the trial and its norm. */
static PetscErrorCode Evaluate(EqmMethod method, EqmIterate iterate, PetscReal *norm)
{
  Implicit *const s = method->data;
  PetscReal sum = 0.;

  PetscFunctionBegin;
  PetscCall(EqmImplicitResidual(&s->step, &iterate->place, s->residual));
  for (PetscInt k = 0; k < 3 * method->problem->mesh->num_owned; k++) sum += PetscSqr(s->residual[k]);
  PetscCall(MPIU_Allreduce(&sum, norm, 1, MPIU_REAL, MPIU_SUM, method->problem->comm));
  *norm = PetscSqrtReal(*norm);
  PetscFunctionReturn(0);
}

/* Newton's method from the present map (004 (9)) with the present time step; the trial is its result. */
static PetscErrorCode Newton(EqmMethod method, EqmIterate iterate, PetscBool *success, PetscInt *iterations)
{
  enum { MOST_ITERATIONS = 12 };
  Implicit *const s = method->data;
  const PetscReal small = 1e-11 * PetscSqrtReal((PetscReal)method->problem->mesh->num_vertices);
  PetscReal norm, first;

  PetscFunctionBegin;
  s->step.dt = s->dt;
  *success = PETSC_TRUE;
  PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &s->trial));
  PetscCall(Evaluate(method, iterate, &first));
  norm = first;
  for (*iterations = 0; norm > small && *success; (*iterations)++) {
    PetscCall(EqmGeneralFactor(s->matrix, EqmImplicitCell, &s->step, 1., success));
    if (!*success) break;
    PetscCall(EqmGeneralSolve(s->matrix, 1, s->residual));
    for (PetscInt k = 0; k < 3 * method->problem->mesh->num_owned; k++) s->trial.x[k] -= s->residual[k];
    PetscCall(EqmMeshUpdateGhosts(method->problem->mesh, 3, s->trial.x));
    PetscCall(Evaluate(method, iterate, &norm));
    *success = (PetscBool)(norm <= 10. * first && *iterations < MOST_ITERATIONS);
  }
  PetscFunctionReturn(0);
}

/* A step whose system Newton's method does not solve, or after which the energy is higher, is halved; one that took few
   iterations is followed by a longer one. */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  enum { FEW = 4 };
  Implicit *const s = method->data;
  const PetscReal before = iterate->totals.energy;
  PetscReal energy = INFINITY, dt = s->dt;
  PetscInt iterations = 0;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (s->ended) PetscFunctionReturn(0);
  *outcome = EQM_STEP_STALLED;
  while (!(energy <= before + s->flow.tol)) {
    PetscBool success;
    if (s->dt < SHORTEST) PetscFunctionReturn(0);
    dt = s->dt;
    PetscCall(Newton(method, iterate, &success, &iterations));
    if (success) {
      PetscCall(EqmFlowNormalise(method->problem, s->flow.moebius, &s->trial));
      PetscCall(EqmFlowEnergy(method->problem, &s->trial, &energy));
    }
    s->dt *= .5;
  }
  s->dt = iterations <= FEW ? 1.5 * dt : dt;
  PetscCall(EqmFlowAccept(method->problem, iterate, &s->trial, dt));
  PetscCall(EqmFlowJudge(method, energy - before, &s->ended));
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateEulerImplicit(EqmMethod method)
{
  Implicit *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  s->flow.tol = EQM_FLOW_TOL;
  method->data = s;
  method->purpose = "implicit Euler method (004 (8)): Newton's method on the coupled system in each step";
  method->ops = (EqmMethodOps){
      .set_from_options = EqmFlowSetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
