/* Energies, their gradients against central differences along geodesics, second derivatives, identities of Laplacians.
 */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "energy/curvature.h"

/* A function of a map. */
typedef PetscErrorCode (*Function)(EqmDomain domain, const EqmPlace *place, PetscReal *value, Vec gradient);

static PetscErrorCode Authalic(EqmDomain domain, const EqmPlace *place, PetscReal *value, Vec gradient)
{
  PetscReal *a;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(domain->mesh->num_local_cells, &a));
  PetscCall(EqmAuthalicEnergy(domain, place, a, value, gradient));
  PetscCall(PetscFree(a));
  PetscFunctionReturn(0);
}

/* E_S = 1/2 tr(f^T L_S f), gradient 2 L_S f (000 (11), 002 (21)); of solids E_V with L_V, gradient 3 L_V f (003 (8)).
 */
static PetscErrorCode Stretch(EqmDomain domain, const EqmPlace *place, PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *weights, *ambient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &weights,
                         domain->dim * mesh->num_owned, &ambient));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_STRETCH, place, weights));
  PetscCall(EqmLaplacianEnergy(mesh, weights, domain->dim, place->x, value));
  if (gradient) {
    PetscCall(EqmLaplacianApply(mesh, weights, domain->dim, place->x, ambient));
    for (PetscInt k = 0; k < domain->dim * mesh->num_owned; k++) ambient[k] *= mesh->cell_size - 1.;
    PetscCall(EqmDomainProject(domain, place, ambient, gradient));
  }
  PetscCall(PetscFree2(weights, ambient));
  PetscFunctionReturn(0);
}

/* The Dirichlet energy of the mesh's cotangents, whose gradient is L f. */
static PetscErrorCode Dirichlet(EqmDomain domain, const EqmPlace *place, PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *weights, *ambient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &weights,
                         domain->dim * mesh->num_owned, &ambient));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_COTANGENT, NULL, weights));
  PetscCall(EqmLaplacianEnergy(mesh, weights, domain->dim, place->x, value));
  if (gradient) {
    PetscCall(EqmLaplacianApply(mesh, weights, domain->dim, place->x, ambient));
    PetscCall(EqmDomainProject(domain, place, ambient, gradient));
  }
  PetscCall(PetscFree2(weights, ambient));
  PetscFunctionReturn(0);
}

static PetscErrorCode At(EqmDomain domain, Function function, const EqmPlace *from, Vec step, PetscReal t,
                         PetscReal *value)
{
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(domain, &to));
  PetscCall(EqmDomainMove(domain, from, t, step, &to));
  PetscCall(function(domain, &to, value, NULL));
  PetscCall(EqmPlaceDestroy(&to));
  PetscFunctionReturn(0);
}

/* The gradient's product with random directions against differences of fourth order. */
static PetscErrorCode TestGradient(EqmDomain domain, Function function, const EqmPlace *place)
{
  const PetscReal h = 1e-3;
  PetscReal value, value_at[4], product, norm, step_norm;
  Vec gradient, step;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(domain, &gradient));
  PetscCall(VecDuplicate(gradient, &step));
  PetscCall(function(domain, place, &value, gradient));
  PetscCall(VecNorm(gradient, NORM_2, &norm));
  CHECK(norm > 1e-3, "the gradient %g is too small to show anything", (double)norm);
  for (PetscInt seed = 0; seed < 4; seed++) {
    PetscCall(TestRandomStep(domain, seed, .1, step));
    if (seed == 3) PetscCall(VecAXPBY(step, .05 / norm, 0., gradient)); /* where the derivative is largest */
    for (int k = 0; k < 4; k++) PetscCall(At(domain, function, place, step, (k < 2 ? k - 2 : k - 1) * h, &value_at[k]));
    PetscCall(VecDot(gradient, step, &product));
    PetscCall(VecNorm(step, NORM_2, &step_norm));
    const PetscReal difference = (8. * (value_at[2] - value_at[1]) - (value_at[3] - value_at[0])) / (12. * h);
    CHECK_CLOSE(difference, product, 1e-8, norm * step_norm + PetscAbsReal(product));
  }
  PetscCall(VecDestroy(&gradient));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

/* First and second derivative of every image area along a geodesic. */
static PetscErrorCode TestSecondDerivatives(EqmDomain domain, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt m = mesh->num_local_cells, n = domain->dim * mesh->num_local;
  const PetscReal h = 1e-3;
  PetscReal *velocity, *acceleration, *first, *second, *a, largest = 0.;
  EqmPlace to;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(n, &velocity, n, &acceleration, m, &first, m, &second, 5 * m, &a));
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(EqmPlaceCreate(domain, &to));
  PetscCall(TestRandomStep(domain, 7, .5, step));
  PetscCall(EqmDomainExpand(domain, place, step, velocity));
  PetscCall(EqmDomainCurvature(domain, place, velocity, acceleration));
  PetscCall(EqmImageDerivatives(domain, place, velocity, acceleration, first, second));
  for (int k = 0; k < 5; k++) {
    PetscCall(EqmDomainMove(domain, place, (k - 2) * h, step, &to));
    PetscCall(EqmImageMeasure(domain, &to, a + k * m));
  }
  for (PetscInt c = 0; c < m; c++) {
    const PetscReal rate = (8. * (a[3 * m + c] - a[m + c]) - (a[4 * m + c] - a[c])) / (12. * h);
    const PetscReal second_derivative =
        (16. * (a[3 * m + c] + a[m + c]) - (a[4 * m + c] + a[c]) - 30. * a[2 * m + c]) / (12. * h * h);
    CHECK_CLOSE(first[c], rate, 1e-9, 1.);
    CHECK_CLOSE(second[c], second_derivative, 1e-7, 1.);
    largest = PetscMax(largest, PetscAbsReal(second[c]));
  }
  CHECK(TestMax(mesh->comm, largest) > 1e-2, "the second derivatives are too small to show anything");
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree5(velocity, acceleration, first, second, a));
  PetscFunctionReturn(0);
}

/* E_S = sum a^2/w (002 Theorem 2), and E = E_S - A with weights that sum to one and the mean ratio one (000 (4)). */
static PetscErrorCode TestStretchIdentities(EqmDomain domain, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *a, stretch, energy, squares = 0., mean = 0., weight = 0.;
  EqmImageTotals totals;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &a));
  PetscCall(Stretch(domain, place, &stretch, NULL));
  PetscCall(EqmAuthalicEnergy(domain, place, a, &energy, NULL));
  PetscCall(EqmImageSum(mesh, a, &totals));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    squares += a[c] * a[c] / mesh->weight[c];
    mean += a[c] / totals.total;
    weight += mesh->weight[c];
  }
  CHECK_CLOSE(TestSum(mesh->comm, squares), stretch, 1e-12, stretch);
  CHECK_CLOSE(stretch / totals.total - totals.total, energy, 1e-12, stretch / totals.total);
  CHECK_CLOSE(TestSum(mesh->comm, mean), 1., 1e-12, 1.);
  CHECK_CLOSE(TestSum(mesh->comm, weight), 1., 1e-12, 1.);
  CHECK(energy == totals.energy, "%.17g and %.17g", (double)energy, (double)totals.energy);
  PetscCall(PetscFree(a));
  PetscFunctionReturn(0);
}

/* Constants are in the null space: rows sum to zero, exactly, for differences come first; and x^T L y = y^T L x. */
static PetscErrorCode TestLaplacian(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *weights, *x, *y, product[2] = {0., 0.}, energy, half = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &weights, 3 * mesh->num_local, &x,
                         3 * mesh->num_owned, &y));
  PetscCall(EqmLaplacianWeights(domain, kind, place, weights));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    x[3 * v] = 1. / 3.;
    for (PetscInt k = 1; k < 3; k++) x[3 * v + k] = TestRandom(k, mesh->vertex_input[v], 0);
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, x));
  PetscCall(EqmLaplacianApply(mesh, weights, 3, x, y));
  PetscCall(EqmLaplacianEnergy(mesh, weights, 3, x, &energy));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    CHECK(y[3 * v] == 0., "row %d sums to %g", (int)mesh->vertex_input[v], (double)y[3 * v]);
    product[0] += x[3 * v + 1] * y[3 * v + 2];
    product[1] += x[3 * v + 2] * y[3 * v + 1];
    for (PetscInt k = 0; k < 3; k++) half += .5 * x[3 * v + k] * y[3 * v + k];
  }
  CHECK_CLOSE(TestSum(mesh->comm, product[0]), TestSum(mesh->comm, product[1]), 1e-12, energy);
  CHECK_CLOSE(TestSum(mesh->comm, half), energy, 1e-12, energy);
  PetscCall(PetscFree3(weights, x, y));
  PetscFunctionReturn(0);
}

/* Every derivative of a cell's measure that the Hessian takes, against those along one geodesic. */
static PetscErrorCode TestCellDerivatives(EqmDomain domain, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *velocity, *acceleration, *first, *second;
  const PetscScalar *s;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(domain->dim * mesh->num_local, &velocity, domain->dim * mesh->num_local, &acceleration,
                         mesh->num_local_cells, &first, mesh->num_local_cells, &second));
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(TestRandomStep(domain, 11, .5, step));
  PetscCall(EqmDomainExpand(domain, place, step, velocity));
  PetscCall(EqmDomainCurvature(domain, place, velocity, acceleration));
  PetscCall(EqmImageDerivatives(domain, place, velocity, acceleration, first, second));
  PetscCall(VecGetArrayRead(step, &s));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    EqmCellDerivatives d;
    PetscReal x[EQM_MOST_CELL_DOFS], rate = 0., second_derivative = 0., size = 1.;
    PetscInt n = 0;
    PetscBool mine = PETSC_TRUE;
    EqmCellDifferentiate(domain, place, c, &d);
    for (PetscInt a = 0; a < mesh->cell_size; a++) {
      const PetscInt v = mesh->cells[mesh->cell_size * c + a];
      mine = (PetscBool)(mine && v < mesh->num_owned);
      for (PetscInt k = 0; k < domain->dof_count[v]; k++, n++)
        x[n] = mine ? s[domain->dof_start[v] - domain->dof_first + k] : 0.;
    }
    CHECK(n == d.frame.count, "%d degrees of freedom, not %d", (int)d.frame.count, (int)n);
    if (!mine) continue;
    for (PetscInt i = 0; i < n; i++) {
      rate += d.first[i] * x[i];
      for (PetscInt j = 0; j < n; j++) second_derivative += x[i] * d.second[i][j] * x[j];
      size += x[i] * x[i];
    }
    CHECK_CLOSE(rate, first[c], 1e-13, size);
    CHECK_CLOSE(second_derivative, second[c], 1e-13, size);
  }
  PetscCall(VecRestoreArrayRead(step, &s));
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree4(velocity, acceleration, first, second));
  PetscFunctionReturn(0);
}

/* grad E_V = 3 L_V f, each to the rounding of one cell's terms, not of the sum (003 (8)). */
static PetscErrorCode TestStretchGradient(EqmDomain domain, const EqmPlace *place)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal *weights, *a, *by_matrix, *by_cells, largest = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &weights, mesh->num_local_cells, &a,
                         domain->dim * mesh->num_owned, &by_matrix, domain->dim * mesh->num_owned, &by_cells));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_STRETCH, place, weights));
  PetscCall(EqmLaplacianApply(mesh, weights, domain->dim, place->x, by_matrix));
  PetscCall(EqmImageMeasure(domain, place, a));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) a[c] *= 2. / mesh->weight[c];
  PetscCall(EqmImageGradient(domain, place, a, by_cells));
  for (PetscInt k = 0; k < domain->dim * mesh->num_owned; k++) largest = PetscMax(largest, PetscAbsReal(by_cells[k]));
  largest = TestMax(mesh->comm, largest);
  for (PetscInt k = 0; k < domain->dim * mesh->num_owned; k++)
    CHECK_CLOSE((mesh->cell_size - 1.) * by_matrix[k], by_cells[k], 1e-12, largest);
  PetscCall(PetscFree4(weights, a, by_matrix, by_cells));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestPlace(EqmDomain domain, const EqmPlace *place)
{
  static const Function functions[] = {Authalic, Stretch, Dirichlet};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(functions); k++)
    PetscCall(TestGradient(domain, functions[k], place));
  PetscCall(TestSecondDerivatives(domain, place));
  PetscCall(TestCellDerivatives(domain, place));
  PetscCall(TestStretchIdentities(domain, place));
  PetscCall(TestStretchGradient(domain, place));
  PetscCall(TestLaplacian(domain, EQM_LAPLACIAN_UNIFORM, place));
  PetscCall(TestLaplacian(domain, EQM_LAPLACIAN_COTANGENT, place));
  PetscCall(TestLaplacian(domain, EQM_LAPLACIAN_STRETCH, place));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestTarget(const char *shape, PetscInt n, const char *target)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 3, &test));
  PetscCall(TestStart(test.mesh, target, &solver));
  PetscCall(TestPlace(solver->problem->domain, &solver->iterate->place));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* A ball, shaken: identities and derivatives hold for any map. */
static PetscErrorCode TestSolid(void)
{
  TestMesh test;
  EqmDomain domain;
  EqmPlace place;
  PetscReal *a, energy;
  PetscInt64 folds;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "ball", 600, 3, &test));
  PetscCall(EqmDomainCreateBall(test.mesh, PETSC_FALSE, &domain));
  PetscCall(EqmPlaceCreate(domain, &place));
  PetscCall(TestShakenBall(domain, 5, .03, &place));
  PetscCall(TestPlace(domain, &place));
  PetscCall(PetscMalloc1(test.mesh->num_local_cells, &a));
  PetscCall(TestShakenBall(domain, 5, 0., &place));
  PetscCall(EqmImageFolds(domain, &place, a, &folds));
  CHECK(folds == 0, "%d folds", (int)folds);
  PetscCall(EqmImageBoundaryFolds(domain, &place, &folds));
  CHECK(folds == 0, "%d folds of the boundary", (int)folds);
  for (PetscInt v = 0; v < test.mesh->num_local; v++) place.x[3 * v] *= -1.;
  PetscCall(EqmImageFolds(domain, &place, a, &folds));
  CHECK(folds == test.mesh->num_cells, "%d folds in a mirrored map", (int)folds);
  PetscCall(EqmImageBoundaryFolds(domain, &place, &folds));
  CHECK(folds == 2 * test.mesh->num_boundary_vertices - 4, "%d folds of a mirrored boundary", (int)folds);
  PetscCall(EqmAuthalicEnergy(domain, &place, a, &energy, NULL));
  CHECK(PetscIsInfReal(energy) && energy > 0., "energy %g: a descent could end in a mirrored map", (double)energy);
  PetscCall(PetscFree(a));
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestTarget("hills", 400, "disk"));
  PetscCall(TestTarget("cap", 300, "disk"));
  PetscCall(TestTarget("hills", 400, "square"));
  PetscCall(TestTarget("patch", 300, "square"));
  PetscCall(TestSolid());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
