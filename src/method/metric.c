/* A Laplacian, of most objectives the stretch Laplacian, as a metric for gradients. In the plane M = blkdiag(L_II,
   L_BB) (000 section 3.2), degree of freedom by degree of freedom, angles and slides with the first coordinate. On the
   sphere the gradient is a field in space: each coordinate is solved with the Laplacian and a mass, and the result
   projected back (docs/methods.md, Published methods). In the ball no Laplacian knows that the energy is stiff for
   compression and soft for everything else: there the metric is the Gauss-Newton matrix with a little of L_V, coupled
   over all coordinates (docs/methods.md, Solids). */
#include "method/method.h"
#include "geometry/simplex.h"
#include "unfold/barrier.h"

struct _p_EqmMetric {
  PetscReal *weights;
  EqmPlace at;            /* the map that the present factor belongs to */
  EqmLinear gauss_newton; /* in the ball, with vertices in frames; else NULL, and there is a Laplacian, below */
  EqmPlace coarse_at;     /* the map that the coarse spaces of multigrid belong to, and whether they serve on */
  PetscBool keeps_coarse;
  PetscReal *mass, *columns, *ambient;
  signed char *group;
};

/* A vertex in spherical coordinates has no frame that a factor could turn with. */
static PetscBool NeedsGaussNewton(EqmDomain domain)
{
  return (PetscBool)(domain->measure == EQM_MEASURE_VOLUME && !domain->spherical_coordinates);
}

/* What a Laplacian's matrix and its columns of right-hand sides take. */
static PetscErrorCode MakeRoomForLaplacian(EqmSolver solver, EqmMetric metric)
{
  const EqmMesh mesh = solver->mesh;
  const PetscInt dim = solver->domain->dim;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_local_cells, &metric->mass, dim * mesh->num_owned, &metric->columns,
                         dim * mesh->num_local, &metric->ambient, mesh->num_local, &metric->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    metric->group[v] = solver->domain->kind[v] == EQM_VERTEX_FIXED ? EQM_GROUP_FIXED : mesh->on_boundary[v] ? 1 : 0;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricCreate(EqmSolver solver, EqmMetric *out)
{
  const EqmMesh mesh = solver->mesh;
  EqmMetric metric;

  PetscFunctionBegin;
  PetscCall(PetscNew(&metric));
  PetscCall(PetscMalloc1(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &metric->weights));
  PetscCall(EqmPlaceCreate(solver->domain, &metric->at));
  if (NeedsGaussNewton(solver->domain)) {
    PetscCall(EqmPlaceCreate(solver->domain, &metric->coarse_at));
    PetscCall(EqmSolverCreateLinear(solver, EQM_MATRIX_METRIC, &metric->gauss_newton));
  } else {
    PetscCall(MakeRoomForLaplacian(solver, metric));
  }
  *out = metric;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricDestroy(EqmMetric *metric)
{
  PetscFunctionBegin;
  if (!*metric) PetscFunctionReturn(0);
  PetscCall(EqmPlaceDestroy(&(*metric)->at));
  PetscCall(EqmPlaceDestroy(&(*metric)->coarse_at));
  PetscCall(PetscFree((*metric)->weights));
  PetscCall(PetscFree4((*metric)->mass, (*metric)->columns, (*metric)->ambient, (*metric)->group));
  PetscCall(EqmLinearDestroy(&(*metric)->gauss_newton));
  PetscCall(PetscFree(*metric));
  PetscFunctionReturn(0);
}

typedef struct {
  EqmSolver solver;
  const PetscReal *weights; /* of L_V */
} GaussNewton;

/* Of L_V in the metric of the ball. */
static const PetscReal l_v_share = .05;

/* Half of the energy's Hessian times A without the curvature of the cells, da da^T / w, and a share of L_V in each
   coordinate, which keeps it definite. */
static void CellGaussNewton(void *context, PetscInt cell, PetscReal *matrix)
{
  const GaussNewton *const gn = context;
  const EqmDomain domain = gn->solver->domain;
  const PetscInt *const v = domain->mesh->cells + 4 * cell;
  const PetscReal *const x = gn->solver->place.x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  PetscReal gradient[4][3], laplacian[4][4];
  EqmCellFrame frame;

  EqmCellFrameFind(domain, &gn->solver->place, cell, &frame);
  for (PetscInt k = 0; k < frame.count * frame.count; k++) matrix[k] = 0.;
  EqmVolumeGradient(p, gradient[0]);
  EqmCellFrameAddSquare(&frame, 1. / domain->mesh->weight[cell], gradient, matrix);
  EqmCellLaplacian(4, gn->weights + 6 * cell, laplacian);
  EqmCellFrameAddLaplacian(&frame, l_v_share, laplacian, matrix);
  if (gn->solver->barrier) EqmBarrierAddMatrix(gn->solver, cell, &frame, matrix);
}

/* Without compression, and the smoothest that there are. Rotations cost a third more per cycle and save less. */
static void Translation(PetscInt which, const PetscReal *x, PetscReal *velocity)
{
  (void)x;
  for (PetscInt k = 0; k < 3; k++) velocity[k] = k == which ? 1. : 0.;
}

static PetscErrorCode FactorGaussNewton(EqmSolver solver, EqmMetric metric)
{
  GaussNewton gn = {solver, metric->weights};
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(EqmLinearKeepCoarseSpaces(metric->gauss_newton, metric->keeps_coarse));
  PetscCall(EqmSolverSetFields(solver, &solver->place, metric->gauss_newton, 3, Translation));
  PetscCall(EqmLinearFactor(metric->gauss_newton, CellGaussNewton, &gn, 1., &success));
  PetscCheck(success, solver->comm, PETSC_ERR_MAT_CH_ZRPVT, "no factor of the metric: the map is not finite");
  PetscFunctionReturn(0);
}

/* Factor what belongs to the present map. */
static PetscErrorCode Factor(EqmSolver solver, EqmMetric metric)
{
  const PetscBool fixed = solver->problem->objective->fixed_metric;
  PetscBool with_mass;

  PetscFunctionBegin;
  if (fixed && solver->holds_fixed_metric) PetscFunctionReturn(0);
  PetscCall(solver->problem->objective->metric(solver, metric->weights, metric->mass, &with_mass));
  if (metric->gauss_newton)
    PetscCall(FactorGaussNewton(solver, metric));
  else
    PetscCall(EqmGroupFactor(solver, metric->weights, metric->group, with_mass ? metric->mass : NULL));
  solver->holds_fixed_metric = fixed;
  PetscFunctionReturn(0);
}

/* The barrier's matrices change too much for common coarse spaces. */
static PetscErrorCode FactorAt(EqmSolver solver, EqmMetric metric, const EqmPlace *place)
{
  const EqmPlace present = solver->place;

  PetscFunctionBegin;
  solver->place = *place; /* for as long as it takes to factor what belongs there */
  PetscCall(Factor(solver, metric));
  solver->place = present;
  metric->keeps_coarse = (PetscBool)(metric->gauss_newton && !solver->barrier);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricRefresh(EqmSolver solver, EqmMetric metric)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &metric->at));
  if (metric->gauss_newton && !metric->keeps_coarse)
    PetscCall(EqmPlaceCopy(solver->domain, &metric->at, &metric->coarse_at));
  PetscCall(FactorAt(solver, metric, &metric->at));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricState(EqmSolver solver, EqmMetric metric, EqmState state)
{
  PetscFunctionBegin;
  PetscCall(EqmStatePlace(state, solver->domain, "metric_of", &metric->at));
  if (metric->gauss_newton) PetscCall(EqmStatePlace(state, solver->domain, "coarse_spaces_of", &metric->coarse_at));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  metric->keeps_coarse = PETSC_FALSE;
  if (metric->gauss_newton && EqmLinearHasCoarseSpaces(metric->gauss_newton))
    PetscCall(FactorAt(solver, metric, &metric->coarse_at));
  PetscCall(FactorAt(solver, metric, &metric->at));
  PetscFunctionReturn(0);
}

/* One column per coordinate in space. */
static PetscErrorCode ApplyInSpace(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  const PetscInt n = solver->mesh->num_owned, dim = solver->domain->dim;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpand(solver->domain, &solver->place, g, metric->ambient));
  for (PetscInt k = 0; k < dim * n; k++) metric->columns[(k % dim) * n + k / dim] = metric->ambient[k];
  PetscCall(EqmGroupApply(solver, dim, metric->columns));
  for (PetscInt k = 0; k < dim * n; k++) metric->ambient[k] = metric->columns[(k % dim) * n + k / dim];
  PetscCall(EqmDomainProject(solver->domain, &solver->place, metric->ambient, h));
  PetscFunctionReturn(0);
}

/* One column per degree of freedom of a vertex. */
static PetscErrorCode ApplyByDof(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  const EqmDomain domain = solver->domain;
  const PetscInt n = solver->mesh->num_owned;
  const PetscScalar *from;
  PetscScalar *to;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(g, &from));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < domain->dim; k++) {
      metric->columns[k * n + v] = k < domain->dof_count[v] ? from[domain->dof_start[v] - domain->dof_first + k] : 0.;
    }
  }
  PetscCall(VecRestoreArrayRead(g, &from));
  PetscCall(EqmGroupApply(solver, domain->dim, metric->columns));
  PetscCall(VecGetArrayWrite(h, &to));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < domain->dof_count[v]; k++)
      to[domain->dof_start[v] - domain->dof_first + k] = metric->columns[k * n + v];
  }
  PetscCall(VecRestoreArrayWrite(h, &to));
  PetscFunctionReturn(0);
}

/* All at once: the matrix belongs to A/2 times the Hessian. */
static PetscErrorCode ApplyCoupled(EqmMetric metric, Vec g, Vec h)
{
  PetscScalar *array;

  PetscFunctionBegin;
  if (g != h) PetscCall(VecCopy(g, h));
  PetscCall(VecGetArray(h, &array));
  PetscCall(EqmLinearApply(metric->gauss_newton, 1, array, array));
  PetscCall(VecRestoreArray(h, &array));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricApply(EqmSolver solver, EqmMetric metric, Vec g, Vec h)
{
  PetscFunctionBegin;
  if (metric->gauss_newton)
    PetscCall(ApplyCoupled(metric, g, h));
  else if (solver->domain->curved_image)
    PetscCall(ApplyInSpace(solver, metric, g, h));
  else
    PetscCall(ApplyByDof(solver, metric, g, h));
  PetscFunctionReturn(0);
}
