/* The fixed-point iteration of stretch energy minimisation: disk with a moving boundary (000 (14)), square (002
   Algorithm 1). */
#include "method/method.h"
#include "domain/domain_private.h"

typedef struct {
  PetscReal *weights, *columns, *inverted;
  signed char *group;
  EqmPlace to;
} FixedPoint;

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  FixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &fp->weights, 2 * mesh->num_owned,
                         &fp->columns, 2 * mesh->num_local, &fp->inverted, mesh->num_local, &fp->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) fp->group[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmPlaceCreate(method->problem->domain, &fp->to));
  iterate->gradient_norm = -1.;
  iterate->objective = iterate->totals.energy;
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  FixedPoint *const fp = method->data;

  PetscFunctionBegin;
  PetscCall(PetscFree4(fp->weights, fp->columns, fp->inverted, fp->group));
  PetscCall(EqmPlaceDestroy(&fp->to));
  PetscFunctionReturn(0);
}

/* New columns for one group of vertices: -L_gg^-1 L_gh z_h, where `z` (per local vertex, two coordinates) is zero on
   the group. */
static PetscErrorCode SolveGroup(EqmMethod method, EqmIterate iterate, signed char group, const PetscReal *z)
{
  FixedPoint *const fp = method->data;
  const PetscInt n = method->problem->mesh->num_owned;
  PetscReal *rhs;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n, &rhs));
  PetscCall(EqmLaplacianApply(method->problem->mesh, fp->weights, 2, z, rhs));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->columns[c * n + v] = fp->group[v] == group ? -rhs[2 * v + c] : 0.;
  }
  PetscCall(PetscFree(rhs));
  PetscCall(EqmGroupSolve(method->problem, 2, fp->columns));
  PetscFunctionReturn(0);
}

/* 000 (14b): the boundary follows the interior, inverted in the circle; then centred (14d) and put on the circle (14e).
 */
static PetscErrorCode MoveBoundary(EqmMethod method, EqmIterate iterate)
{
  FixedPoint *const fp = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = mesh->num_owned;
  PetscReal sum[2] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const x = iterate->place.x + 2 * v, squared = x[0] * x[0] + x[1] * x[1];
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = fp->group[v] == 0 ? x[c] / squared : 0.;
  }
  PetscCall(SolveGroup(method, iterate, 1, fp->inverted));
  for (PetscInt v = 0; v < n; v++) {
    if (fp->group[v] != 1) continue;
    for (PetscInt c = 0; c < 2; c++) sum[c] += fp->columns[c * n + v];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt v = 0; v < n; v++) {
    if (fp->group[v] != 1) continue;
    const PetscReal b[2] = {fp->columns[v] - sum[0] / mesh->num_boundary_vertices,
                            fp->columns[n + v] - sum[1] / mesh->num_boundary_vertices};
    const PetscReal length = PetscSqrtReal(b[0] * b[0] + b[1] * b[1]);
    for (PetscInt c = 0; c < 2; c++) iterate->place.x[2 * v + c] = b[c] / length;
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, iterate->place.x));
  PetscFunctionReturn(0);
}

/* One pass of 000 (14) in the order that reproduces the published table: boundary first, then the interior with the new
   boundary, both with L_S of the old map. */
static PetscErrorCode StepOnDisk(EqmMethod method, EqmIterate iterate)
{
  FixedPoint *const fp = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  PetscCall(EqmGroupFactor(method->problem, fp->weights, fp->group, NULL));
  PetscCall(MoveBoundary(method, iterate));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = fp->group[v] == 1 ? iterate->place.x[2 * v + c] : 0.;
  }
  PetscCall(SolveGroup(method, iterate, 0, fp->inverted));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2 && fp->group[v] == 0; c++) iterate->place.x[2 * v + c] = fp->columns[c * n + v];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, iterate->place.x));
  PetscFunctionReturn(0);
}

/* One pass of the iteration for the domain. */
static PetscErrorCode Pass(EqmMethod method, EqmIterate iterate)
{
  FixedPoint *const fp = method->data;

  PetscFunctionBegin;
  if (method->problem->domain->curved_image) {
    PetscCall(EqmSphereFixedPointStep(method->problem, iterate, iterate->number, fp->weights));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmLaplacianWeights(method->problem->domain, EQM_LAPLACIAN_STRETCH, &iterate->place, fp->weights));
  if (method->problem->domain->motion[1] == &EqmMotionCircle) {
    PetscCall(StepOnDisk(method, iterate));
  } else {
    PetscCall(EqmHarmonicMap(method->problem, fp->weights, &iterate->place, &fp->to));
    PetscCall(EqmPlaceCopy(method->problem->domain, &fp->to, &iterate->place));
  }
  PetscFunctionReturn(0);
}

/* On the sphere the iteration does not converge: it ends where the energy first rises (001 Algorithm 2). */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  FixedPoint *const fp = method->data;
  const PetscReal before = iterate->totals.energy;

  PetscFunctionBegin;
  *outcome = EQM_STEP_TAKEN;
  if (method->problem->domain->curved_image) PetscCall(EqmPlaceCopy(method->problem->domain, &iterate->place, &fp->to));
  PetscCall(Pass(method, iterate));
  PetscCall(EqmIterateUpdate(method->problem, iterate));
  if (method->problem->domain->curved_image && !(iterate->totals.energy < before)) {
    PetscCall(EqmPlaceCopy(method->problem->domain, &fp->to, &iterate->place));
    PetscCall(EqmIterateUpdate(method->problem, iterate));
    PetscCall(PetscStrncpy(method->message,
                           "the next fixed-point step would raise the energy: there the iteration ends",
                           sizeof(method->message)));
    *outcome = EQM_STEP_CONVERGED;
  }
  iterate->step_length = 1.;
  iterate->objective = iterate->totals.energy;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateFixedPoint(EqmMethod method)
{
  FixedPoint *fp;

  PetscFunctionBegin;
  PetscCall(PetscNew(&fp));
  method->data = fp;
  method->purpose = "stretch energy minimisation by fixed-point iteration (000 (14), 001 Algorithm 2, 002 Algorithm 1)";
  method->ops = (EqmMethodOps){.set_up = SetUp, .step = Step, .reset = Reset};
  PetscFunctionReturn(0);
}
