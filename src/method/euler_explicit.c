/* The explicit Euler method (004 section 3.1): no system to solve, but stable for tiny time steps only. */
#include "method/flow.h"

typedef struct {
  PetscReal dt, limit;
  PetscBool ended;
  EqmPlace trial;
  PetscReal *af, *normal; /* A f and <A f, f> per owned vertex */
} Explicit;

/* u <- P (A - <A f, f>) u for tangent fields u at the present map: how the flow's velocity changes with the map. */
static PetscErrorCode ApplyJacobian(EqmSolver solver, Vec u, PetscReal *ambient, PetscReal *image)
{
  Explicit *const e = solver->data;
  const PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmAngleWeights(solver, &weights));
  PetscCall(EqmDomainExpand(solver->domain, &solver->place, u, ambient));
  PetscCall(EqmLaplacianApply(solver->mesh, weights, 3, ambient, image));
  for (PetscInt k = 0; k < 3 * solver->mesh->num_owned; k++) image[k] -= e->normal[k / 3] * ambient[k];
  PetscCall(EqmDomainProject(solver->domain, &solver->place, image, u));
  PetscFunctionReturn(0);
}

/* Two over the largest eigenvalue of the Jacobian, by power iteration from a field of no particular shape. */
static PetscErrorCode FindLimit(EqmSolver solver, PetscReal *limit)
{
  enum { MOST_ITERATIONS = 300 };
  const EqmMesh mesh = solver->mesh;
  Explicit *const e = solver->data;
  PetscReal *ambient, *image, norm, before = 0.;
  PetscScalar *value;
  Vec u;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local, &ambient, 3 * mesh->num_owned, &image));
  PetscCall(EqmDomainCreateVec(solver->domain, &u));
  PetscCall(EqmFlowLaplacian(solver, &solver->place, e->af, e->normal));
  PetscCall(VecGetArrayWrite(u, &value));
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++)
    value[k] = PetscCosReal(1. + 2. * mesh->vertex_input[k / 2] + k % 2);
  PetscCall(VecRestoreArrayWrite(u, &value));
  PetscCall(VecNormalize(u, &norm));
  for (PetscInt k = 0; k < MOST_ITERATIONS; k++) {
    PetscCall(ApplyJacobian(solver, u, ambient, image));
    PetscCall(VecNormalize(u, &norm));
    if (PetscAbsReal(norm - before) <= 1e-5 * norm) break;
    before = norm;
  }
  *limit = 2. / norm;
  PetscCall(VecDestroy(&u));
  PetscCall(PetscFree2(ambient, image));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmSolver solver)
{
  Explicit *e;

  PetscFunctionBegin;
  PetscCall(PetscNew(&e));
  solver->data = e;
  PetscCall(PetscMalloc2(3 * solver->mesh->num_owned, &e->af, solver->mesh->num_owned, &e->normal));
  PetscCall(EqmPlaceCreate(solver->domain, &e->trial));
  PetscCall(FindLimit(solver, &e->limit));
  e->dt = solver->settings.flow_step > 0. ? solver->settings.flow_step : .9 * e->limit;
  PetscCall(EqmFlowAccept(solver, &solver->place, 0.));
  if (!solver->settings.quiet) {
    PetscCall(PetscPrintf(solver->comm, "explicit Euler is stable for time steps below %.4g here; it takes %.4g\n",
                          (double)e->limit, (double)e->dt));
  }
  PetscFunctionReturn(0);
}

/* The limit is that of the first map. */
static PetscErrorCode State(EqmSolver solver, EqmState state)
{
  Explicit *const e = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "limit", &e->limit));
  PetscCall(EqmFlowState(solver, state, &e->dt, &e->ended));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Explicit *const e = solver->data;

  PetscFunctionBegin;
  PetscCall(PetscFree2(e->af, e->normal));
  PetscCall(EqmPlaceDestroy(&e->trial));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Explicit *const e = solver->data;
  const PetscReal before = solver->totals.energy, rise = .05;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (e->ended) PetscFunctionReturn(0);
  PetscCall(EqmFlowLaplacian(solver, &solver->place, e->af, e->normal));
  for (PetscInt k = 0; k < 3 * solver->mesh->num_owned; k++) {
    const PetscReal x = solver->place.x[k];
    e->trial.x[k] = x - e->dt * (e->af[k] - e->normal[k / 3] * x);
  }
  PetscCall(EqmFlowNormalise(solver, solver->settings.flow_moebius, &e->trial));
  PetscCall(EqmFlowAccept(solver, &e->trial, e->dt));
  PetscCall(EqmFlowJudge(solver, solver->totals.energy - before, &e->ended));
  *outcome = EQM_STEP_TAKEN;
  if (solver->totals.energy < before + rise) PetscFunctionReturn(0); /* centring may cost a little */
  *outcome = EQM_STEP_STALLED;
  PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                          "the energy rises: the time step %.4g is too long (stability ends near %.4g)", (double)e->dt,
                          (double)e->limit));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodEulerExplicit = {
    .name = "euler-explicit",
    .purpose = "explicit Euler method (004 section 3.1), with its stability limit",
    .options = EqmFlowOptions,
    .set_up = SetUp,
    .step = Step,
    .state = State,
    .destroy = Destroy,
};
