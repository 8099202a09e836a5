/* The explicit Euler method (004 section 3.1): no system to solve, but stable for tiny time steps only. */
#include "method/flow.h"
#include "mesh/mesh_private.h"

typedef struct {
  EqmFlowSettings flow;
  PetscReal dt, limit;
  PetscBool ended;
  EqmPlace trial;
  PetscReal *af, *normal; /* A f and <A f, f> per owned vertex */
} Explicit;

/* u <- P (A - <A f, f>) u for tangent fields u at the present map: how the flow's velocity changes with the map. */
static PetscErrorCode ApplyJacobian(EqmMethod method, EqmIterate iterate, Vec u, PetscReal *ambient, PetscReal *image)
{
  Explicit *const e = method->data;
  const PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(method->problem, &weights));
  PetscCall(EqmDomainExpand(method->problem->domain, &iterate->place, u, ambient));
  PetscCall(EqmLaplacianApply(method->problem->mesh, weights, 3, ambient, image));
  for (PetscInt k = 0; k < 3 * method->problem->mesh->num_owned; k++) image[k] -= e->normal[k / 3] * ambient[k];
  PetscCall(EqmDomainProject(method->problem->domain, &iterate->place, image, u));
  PetscFunctionReturn(0);
}

/* Two over the largest eigenvalue of the Jacobian, by power iteration from a pseudo-random field. */
static PetscErrorCode FindLimit(EqmMethod method, EqmIterate iterate, PetscReal *limit)
{
  enum { MOST_ITERATIONS = 300 };
  const EqmMesh mesh = method->problem->mesh;
  Explicit *const e = method->data;
  PetscReal *ambient, *image, norm, before = 0.;
  PetscScalar *value;
  Vec u;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local, &ambient, 3 * mesh->num_owned, &image));
  PetscCall(EqmDomainCreateVec(method->problem->domain, &u));
  PetscCall(EqmFlowLaplacian(method->problem, &iterate->place, e->af, e->normal));
  PetscCall(VecGetArrayWrite(u, &value));
  for (PetscInt k = 0; k < 2 * mesh->num_owned; k++)
    value[k] = PetscCosReal(1. + 2. * mesh->vertex_input[k / 2] + k % 2);
  PetscCall(VecRestoreArrayWrite(u, &value));
  PetscCall(VecNormalize(u, &norm));
  for (PetscInt k = 0; k < MOST_ITERATIONS; k++) {
    PetscCall(ApplyJacobian(method, iterate, u, ambient, image));
    PetscCall(VecNormalize(u, &norm));
    if (PetscAbsReal(norm - before) <= 1e-5 * norm) break;
    before = norm;
  }
  *limit = 2. / norm;
  PetscCall(VecDestroy(&u));
  PetscCall(PetscFree2(ambient, image));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  Explicit *const e = method->data;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * method->problem->mesh->num_owned, &e->af, method->problem->mesh->num_owned, &e->normal));
  PetscCall(EqmPlaceCreate(method->problem->domain, &e->trial));
  PetscCall(FindLimit(method, iterate, &e->limit));
  e->dt = e->flow.step > 0. ? e->flow.step : .9 * e->limit;
  e->ended = PETSC_FALSE;
  PetscCall(EqmFlowAccept(method->problem, iterate, &iterate->place, 0.));
  PetscCall(EqmProblemNotify(method->problem,
                             "explicit Euler is stable for time steps below %.4g here; it takes %.4g\n",
                             (double)e->limit, (double)e->dt));
  PetscFunctionReturn(0);
}

/* The limit is that of the first map. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Explicit *const e = method->data;

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "limit", &e->limit));
  PetscCall(EqmFlowState(method, state, &e->dt, &e->ended));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Explicit *const e = method->data;

  PetscFunctionBegin;
  PetscCall(PetscFree2(e->af, e->normal));
  PetscCall(EqmPlaceDestroy(&e->trial));
  PetscFunctionReturn(0);
}

static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Explicit *const e = method->data;
  const PetscReal before = iterate->totals.energy, rise = .05;

  PetscFunctionBegin;
  *outcome = EQM_STEP_CONVERGED;
  if (e->ended) PetscFunctionReturn(0);
  PetscCall(EqmFlowLaplacian(method->problem, &iterate->place, e->af, e->normal));
  for (PetscInt k = 0; k < 3 * method->problem->mesh->num_owned; k++) {
    const PetscReal x = iterate->place.x[k];
    e->trial.x[k] = x - e->dt * (e->af[k] - e->normal[k / 3] * x);
  }
  PetscCall(EqmFlowNormalise(method->problem, e->flow.moebius, &e->trial));
  PetscCall(EqmFlowAccept(method->problem, iterate, &e->trial, e->dt));
  PetscCall(EqmFlowJudge(method, iterate->totals.energy - before, &e->ended));
  *outcome = EQM_STEP_TAKEN;
  if (iterate->totals.energy < before + rise) PetscFunctionReturn(0); /* centring may raise the energy slightly */
  *outcome = EQM_STEP_STALLED;
  PetscCall(PetscSNPrintf(method->message, sizeof(method->message),
                          "the energy rises: the time step %.4g is too long (stability ends near %.4g)", (double)e->dt,
                          (double)e->limit));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateEulerExplicit(EqmMethod method)
{
  Explicit *e;

  PetscFunctionBegin;
  PetscCall(PetscNew(&e));
  e->flow.tol = EQM_FLOW_TOL;
  method->data = e;
  method->purpose = "explicit Euler method (004 section 3.1), with its stability limit";
  method->ops = (EqmMethodOps){
      .set_from_options = EqmFlowSetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
