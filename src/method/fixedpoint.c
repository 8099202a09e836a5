/* The fixed-point iteration of stretch energy minimisation: disk with a moving boundary (000 (14)), square (002
 * Algorithm 1). */
#include "method/method.h"

typedef struct {
  PetscReal *weights, *columns, *inverted;
  signed char *group;
  EqmPlace to;
} FixedPoint;

static PetscErrorCode SetUp(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  FixedPoint *fp;

  PetscFunctionBegin;
  PetscCall(PetscNew(&fp));
  solver->data = fp;
  PetscCall(PetscMalloc4(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &fp->weights, 2 * mesh->num_owned,
                         &fp->columns, 2 * mesh->num_local, &fp->inverted, mesh->num_local, &fp->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) fp->group[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmPlaceCreate(solver->domain, &fp->to));
  solver->gradient_norm = -1.;
  solver->objective = solver->totals.energy;
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  FixedPoint *const fp = solver->data;

  PetscFunctionBegin;
  PetscCall(PetscFree4(fp->weights, fp->columns, fp->inverted, fp->group));
  PetscCall(EqmPlaceDestroy(&fp->to));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

/* New columns for one group of vertices: -L_gg^-1 L_gh z_h, where `z` (per local vertex, two coordinates) is zero on
 * the group. */
static PetscErrorCode SolveGroup(EqmSolver solver, signed char group, const PetscReal *z)
{
  FixedPoint *const fp = solver->data;
  const PetscInt n = solver->mesh->num_owned;
  PetscReal *rhs;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n, &rhs));
  PetscCall(EqmLaplacianApply(solver->mesh, fp->weights, 2, z, rhs));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->columns[c * n + v] = fp->group[v] == group ? -rhs[2 * v + c] : 0.;
  }
  PetscCall(PetscFree(rhs));
  PetscCall(EqmGroupSolve(solver, 2, fp->columns));
  PetscFunctionReturn(0);
}

/* 000 (14b): the boundary follows the interior, inverted in the circle; then centred (14d) and put on the circle (14e).
 */
static PetscErrorCode MoveBoundary(EqmSolver solver)
{
  FixedPoint *const fp = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt n = mesh->num_owned;
  PetscReal sum[2] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const x = solver->place.x + 2 * v, squared = x[0] * x[0] + x[1] * x[1];
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = fp->group[v] == 0 ? x[c] / squared : 0.;
  }
  PetscCall(SolveGroup(solver, 1, fp->inverted));
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
    for (PetscInt c = 0; c < 2; c++) solver->place.x[2 * v + c] = b[c] / length;
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, solver->place.x));
  PetscFunctionReturn(0);
}

/* One pass of 000 (14) in the order that reproduces the published table: boundary first, then the interior with the new
   boundary, both with L_S of the old map. */
static PetscErrorCode StepOnDisk(EqmSolver solver)
{
  FixedPoint *const fp = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  PetscCall(EqmGroupFactor(solver, fp->weights, fp->group, NULL));
  PetscCall(MoveBoundary(solver));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    for (PetscInt c = 0; c < 2; c++) fp->inverted[2 * v + c] = fp->group[v] == 1 ? solver->place.x[2 * v + c] : 0.;
  }
  PetscCall(SolveGroup(solver, 0, fp->inverted));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt c = 0; c < 2 && fp->group[v] == 0; c++) solver->place.x[2 * v + c] = fp->columns[c * n + v];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, solver->place.x));
  PetscFunctionReturn(0);
}

/* One pass of the iteration for the domain. */
static PetscErrorCode Pass(EqmSolver solver)
{
  FixedPoint *const fp = solver->data;

  PetscFunctionBegin;
  if (solver->domain->curved_image) {
    PetscCall(EqmSphereFixedPointStep(solver, solver->iteration, fp->weights));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmLaplacianWeights(solver->domain, EQM_LAPLACIAN_STRETCH, &solver->place, fp->weights));
  if (solver->domain->kind_of_boundary == EQM_VERTEX_CIRCLE) {
    PetscCall(StepOnDisk(solver));
  } else {
    PetscCall(EqmHarmonicMap(solver, fp->weights, &solver->place, &fp->to));
    PetscCall(EqmPlaceCopy(solver->domain, &fp->to, &solver->place));
  }
  PetscFunctionReturn(0);
}

/* On the sphere the iteration has no limit to go to: it ends where the energy first rises (001 Algorithm 2). */
static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  FixedPoint *const fp = solver->data;
  const PetscReal before = solver->totals.energy;

  PetscFunctionBegin;
  *outcome = EQM_STEP_TAKEN;
  if (solver->domain->curved_image) PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &fp->to));
  PetscCall(Pass(solver));
  PetscCall(EqmSolverLook(solver));
  if (solver->domain->curved_image && !(solver->totals.energy < before)) {
    PetscCall(EqmPlaceCopy(solver->domain, &fp->to, &solver->place));
    PetscCall(EqmSolverLook(solver));
    PetscCall(PetscStrncpy(solver->message,
                           "the next fixed-point step would raise the energy: there the iteration ends",
                           sizeof(solver->message)));
    *outcome = EQM_STEP_CONVERGED;
  }
  solver->step_length = 1.;
  solver->objective = solver->totals.energy;
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodFixedPoint = {
    .name = "fixed-point",
    .purpose = "stretch energy minimisation by fixed-point iteration (000 (14), 001 Algorithm 2, 002 Algorithm 1)",
    .set_up = SetUp,
    .step = Step,
    .destroy = Destroy,
};
