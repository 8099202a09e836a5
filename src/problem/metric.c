/* A Laplacian, of most objectives the stretch Laplacian, as a metric for gradients. In the plane M = blkdiag(L_II,
   L_BB) (000 section 3.2), degree of freedom by degree of freedom, angles and positions along sides with the first
   coordinate. On the sphere the gradient is a field in space: each coordinate is solved with the Laplacian and a mass,
   and the result projected back (docs/methods.md, Published methods). In the ball the energy is stiff for compression
   and soft for all other deformations, which no scalar Laplacian represents: there the metric is the Gauss-Newton
   matrix with a little of L_V, coupled over all coordinates (docs/methods.md, Solids). */
#include "problem/metric.h"
#include "domain/domain_private.h"
#include "energy/cellframe.h"
#include "problem/objective.h"
#include "problem/solenoidal.h"
#include "geometry/simplex.h"
#include "problem/term.h"

struct _p_EqmMetric {
  EqmProblem problem;
  PetscReal *weights;
  EqmPlace at;            /* the map that the present factor belongs to */
  EqmLinear gauss_newton; /* in the ball, with vertices in frames; else NULL, and there is a Laplacian, below */
  EqmSolenoidal smooth;   /* beside multigrid, where the domain is the ball; else NULL */
  PetscBool adds_smooth;  /* the present factor has a part for it, too */
  EqmPlace coarse_at;     /* the map that multigrid's coarse spaces were built for, and whether they are reused */
  PetscBool keeps_coarse;
  PetscReal *mass, *columns, *ambient;
  signed char *group;
};

/* A vertex in spherical coordinates has no orthonormal frame, in which the coupled matrix is assembled. */
static PetscBool NeedsGaussNewton(EqmDomain domain)
{
  return (PetscBool)(domain->measure == EQM_MEASURE_VOLUME && !domain->spherical_coordinates);
}

static PetscBool IsBall(EqmDomain domain)
{
  return (PetscBool)(domain->motion[1] == &EqmMotionSphere);
}

/* Allocate the work space of a Laplacian metric: columns of right-hand sides. */
static PetscErrorCode CreateLaplacian(EqmProblem problem, EqmMetric metric)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt dim = problem->domain->dim;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_local_cells, &metric->mass, dim * mesh->num_owned, &metric->columns,
                         dim * mesh->num_local, &metric->ambient, mesh->num_local, &metric->group));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    metric->group[v] = problem->domain->dof_count[v] == 0 ? EQM_GROUP_FIXED : mesh->on_boundary[v] ? 1 : 0;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricCreate(EqmProblem problem, EqmMetric *out)
{
  const EqmMesh mesh = problem->mesh;
  EqmMetric metric;

  PetscFunctionBegin;
  PetscCall(PetscNew(&metric));
  metric->problem = problem;
  PetscCall(PetscMalloc1(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &metric->weights));
  PetscCall(EqmPlaceCreate(problem->domain, &metric->at));
  if (NeedsGaussNewton(problem->domain)) {
    PetscCall(EqmPlaceCreate(problem->domain, &metric->coarse_at));
    PetscCall(EqmProblemCreateLinear(problem, EQM_MATRIX_METRIC, &metric->gauss_newton));
    if (EqmLinearHasCoarseSpaces(metric->gauss_newton) && IsBall(problem->domain))
      PetscCall(EqmSolenoidalCreate(problem, &metric->smooth));
  } else {
    PetscCall(CreateLaplacian(problem, metric));
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
  PetscCall(EqmSolenoidalDestroy(&(*metric)->smooth));
  PetscCall(PetscFree(*metric));
  PetscFunctionReturn(0);
}

typedef struct {
  EqmProblem problem;
  const EqmPlace *place;
  const PetscReal *image;   /* measures there; NULL where the objective has no added terms */
  const PetscReal *weights; /* of L_V */
} GaussNewton;

/* Weight of L_V in the metric of the ball. The more, the better multigrid cycles do; the less, the sooner come the
   motions that hardly compress, which take most of the iterations. */
static const PetscReal l_v_share = .01;

/* Half of the objective's Hessian times A without the curvature of the cells: da da^T / w of the energy, a share of L_V
   in each coordinate, which keeps it definite, and the matrices of the added terms. */
static void CellGaussNewton(void *context, PetscInt cell, PetscReal *matrix)
{
  const GaussNewton *const gn = context;
  const EqmDomain domain = gn->problem->domain;
  const PetscInt *const v = domain->mesh->cells + 4 * cell;
  const PetscReal *const x = gn->place->x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  PetscReal gradient[4][3], laplacian[4][4];
  EqmCellFrame frame;

  EqmCellFrameFind(domain, gn->place, cell, &frame);
  for (PetscInt k = 0; k < frame.count * frame.count; k++) matrix[k] = 0.;
  EqmVolumeGradient(p, gradient[0]);
  EqmCellFrameAddSquare(&frame, 1. / domain->mesh->weight[cell], gradient, matrix);
  EqmCellLaplacian(4, gn->weights + 6 * cell, laplacian);
  EqmCellFrameAddLaplacian(&frame, l_v_share, laplacian, matrix);
  EqmTermsAddMatrix(gn->problem, gn->place, gn->image, cell, &frame, domain->target_measure, matrix);
}

/* Translations are the smoothest fields without compression. Rotations as well would cost a third more per cycle and
   save less. */
static void Translation(PetscInt which, const PetscReal *x, PetscReal *velocity)
{
  (void)x;
  for (PetscInt k = 0; k < 3; k++) velocity[k] = k == which ? 1. : 0.;
}

static PetscErrorCode FactorGaussNewton(EqmMetric metric, const EqmPlace *place)
{
  const EqmProblem problem = metric->problem;
  GaussNewton gn = {.problem = problem, .place = place, .weights = metric->weights};
  PetscReal *image = NULL;
  PetscBool success;

  PetscFunctionBegin;
  if (problem->terms) {
    PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &image));
    PetscCall(EqmImageMeasure(problem->domain, place, image));
    gn.image = image;
  }
  PetscCall(EqmLinearKeepCoarseSpaces(metric->gauss_newton, metric->keeps_coarse));
  PetscCall(EqmProblemSetFields(problem, place, metric->gauss_newton, 3, Translation));
  PetscCall(EqmLinearFactor(metric->gauss_newton, CellGaussNewton, &gn, 1., &success));
  PetscCall(PetscFree(image));
  PetscCheck(success, problem->comm, PETSC_ERR_MAT_CH_ZRPVT, "no factor of the metric: the map is not finite");
  metric->adds_smooth = (PetscBool)(metric->smooth && !problem->terms);
  if (metric->adds_smooth) PetscCall(EqmSolenoidalFactor(metric->smooth, place, metric->weights, l_v_share));
  PetscFunctionReturn(0);
}

/* Factor the matrix of a map. With added terms the matrices change too much to reuse coarse spaces. */
static PetscErrorCode FactorAt(EqmMetric metric, const EqmPlace *place)
{
  const EqmProblem problem = metric->problem;
  const PetscBool fixed = problem->objective->fixed_metric;
  PetscBool with_mass;

  PetscFunctionBegin;
  if (!fixed || !problem->holds_fixed_metric) {
    PetscCall(problem->objective->metric(problem, place, metric->weights, metric->mass, &with_mass));
    if (metric->gauss_newton)
      PetscCall(FactorGaussNewton(metric, place));
    else
      PetscCall(EqmGroupFactor(problem, metric->weights, metric->group, with_mass ? metric->mass : NULL));
    problem->holds_fixed_metric = fixed;
  }
  metric->keeps_coarse = (PetscBool)(metric->gauss_newton && !problem->terms);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricRefresh(EqmMetric metric, const EqmPlace *place)
{
  const EqmDomain domain = metric->problem->domain;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(domain, place, &metric->at));
  if (metric->gauss_newton && !metric->keeps_coarse) PetscCall(EqmPlaceCopy(domain, &metric->at, &metric->coarse_at));
  PetscCall(FactorAt(metric, &metric->at));
  PetscFunctionReturn(0);
}

PetscBool EqmMetricIsCycle(EqmMetric metric)
{
  return (PetscBool)(metric->gauss_newton && EqmLinearHasCoarseSpaces(metric->gauss_newton));
}

PetscErrorCode EqmMetricState(EqmMetric metric, EqmState state)
{
  const EqmDomain domain = metric->problem->domain;

  PetscFunctionBegin;
  PetscCall(EqmStatePlace(state, domain, "metric_of", &metric->at));
  if (metric->gauss_newton) PetscCall(EqmStatePlace(state, domain, "coarse_spaces_of", &metric->coarse_at));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  metric->keeps_coarse = PETSC_FALSE;
  if (EqmMetricIsCycle(metric)) PetscCall(FactorAt(metric, &metric->coarse_at));
  PetscCall(FactorAt(metric, &metric->at));
  PetscFunctionReturn(0);
}

/* One column per coordinate in space. */
static PetscErrorCode ApplyInSpace(EqmMetric metric, const EqmPlace *place, Vec g, Vec h)
{
  const EqmProblem problem = metric->problem;
  const PetscInt n = problem->mesh->num_owned, dim = problem->domain->dim;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpandOwned(problem->domain, place, g, metric->ambient));
  for (PetscInt k = 0; k < dim * n; k++) metric->columns[(k % dim) * n + k / dim] = metric->ambient[k];
  PetscCall(EqmGroupApply(problem, dim, metric->columns));
  for (PetscInt k = 0; k < dim * n; k++) metric->ambient[k] = metric->columns[(k % dim) * n + k / dim];
  PetscCall(EqmDomainProject(problem->domain, place, metric->ambient, h));
  PetscFunctionReturn(0);
}

/* One column per degree of freedom of a vertex. */
static PetscErrorCode ApplyByDof(EqmMetric metric, Vec g, Vec h)
{
  const EqmProblem problem = metric->problem;
  const EqmDomain domain = problem->domain;
  const PetscInt n = problem->mesh->num_owned;
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
  PetscCall(EqmGroupApply(problem, domain->dim, metric->columns));
  PetscCall(VecGetArrayWrite(h, &to));
  for (PetscInt v = 0; v < n; v++) {
    for (PetscInt k = 0; k < domain->dof_count[v]; k++)
      to[domain->dof_start[v] - domain->dof_first + k] = metric->columns[k * n + v];
  }
  PetscCall(VecRestoreArrayWrite(h, &to));
  PetscFunctionReturn(0);
}

/* All at once: the matrix belongs to A/2 times the Hessian. To a cycle of multigrid comes what smooth motions without
   compression ask for; with added terms, which may be stiff for these, it does not. */
static PetscErrorCode ApplyCoupled(EqmMetric metric, Vec g, Vec h)
{
  PetscScalar *array;

  PetscFunctionBegin;
  if (metric->adds_smooth) PetscCall(EqmSolenoidalSolve(metric->smooth, &metric->at, g));
  if (g != h) PetscCall(VecCopy(g, h));
  PetscCall(VecGetArray(h, &array));
  PetscCall(EqmLinearApply(metric->gauss_newton, 1, array, array));
  PetscCall(VecRestoreArray(h, &array));
  if (metric->adds_smooth) PetscCall(EqmSolenoidalAdd(metric->smooth, &metric->at, h));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMetricApply(EqmMetric metric, const EqmPlace *place, Vec g, Vec h)
{
  PetscFunctionBegin;
  if (metric->gauss_newton)
    PetscCall(ApplyCoupled(metric, g, h));
  else if (metric->problem->domain->curved_image)
    PetscCall(ApplyInSpace(metric, place, g, h));
  else
    PetscCall(ApplyByDof(metric, g, h));
  PetscFunctionReturn(0);
}
