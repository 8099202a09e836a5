/* Levenberg-Marquardt's parts: gradient, Gauss-Newton matrix with damping and mean term, second derivative along the
   step, predicted decrease, each against differences of the residual itself. What terms add is tested with the terms.
 */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "method/lm.h"
#include "energy/loops.h"
#include <string.h>
#include "support/cellform.h"

/* A solver at its start with three landmarks away from their vertices, or none, its method set up. */
static PetscErrorCode Begin(EqmMesh mesh, const char *target, const char *more, PetscBool landmarks, EqmSolver *solver)
{
  static const PetscInt vertex[3] = {5, 40, 77};
  static const PetscReal weight[3] = {1., .4, 3.};
  static const PetscReal planar[6] = {.3, .4, -.5, .2, .6, -.1},
                         spherical[9] = {.3, .4, .866, -.5, .2, .84, .6, -.1, .79};
  const PetscInt dim = strcmp(target, "sphere") ? 2 : 3;
  char text[128];
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "-method lm -start guarded -start_steps 1 -max_it 0 -quiet %s", more));
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(mesh, target, solver));
  PetscCall(EqmSolverSetFromOptions(*solver));
  if (landmarks)
    PetscCall(EqmSolverSetLandmarks(*solver, 3, dim, vertex, dim == 2 ? planar : spherical, weight, 2., 1e-2));
  PetscCall(EqmSolverSetUp(*solver));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(EqmMethodSetUp((*solver)->method, (*solver)->problem, (*solver)->iterate));
  EqmLm *const lm = (*solver)->method->data;
  if (lm->upright) lm->upright->weight *= .3; /* not one, so that a forgotten factor shows */
  PetscCall(EqmLmLinearise((*solver)->method, (*solver)->iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode End(EqmSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverDestroy(solver));
  PetscFunctionReturn(0);
}

/* Objective and residuals at parameter t of the geodesic of `step`; the result lies in lm->attempt. */
static PetscErrorCode At(EqmSolver solver, Vec step, PetscReal t)
{
  EqmLm *const lm = solver->method->data;

  PetscFunctionBegin;
  PetscCall(EqmDomainMove(solver->problem->domain, &lm->now.place, t, step, &lm->attempt.place));
  PetscCall(EqmLmEvaluate(solver->method, &lm->attempt));
  CHECK(!PetscIsInfOrNanReal(lm->attempt.objective), "a tiny step folds the map");
  PetscFunctionReturn(0);
}

/* Residuals at -2h, -h, 0, h, 2h along `step`, one after the other, per local cell; objectives too. */
static PetscErrorCode Sample(EqmSolver solver, Vec step, PetscReal h, PetscReal *residual, PetscReal objective[5])
{
  EqmLm *const lm = solver->method->data;
  const PetscInt m = solver->mesh->num_local_cells;

  PetscFunctionBegin;
  for (int k = 0; k < 5; k++) {
    PetscCall(At(solver, step, (k - 2) * h));
    PetscCall(PetscArraycpy(residual + k * m, lm->attempt.residual, m));
    objective[k] = lm->attempt.objective;
  }
  PetscFunctionReturn(0);
}

static PetscReal FirstDifference(PetscInt m, const PetscReal *f, PetscReal h)
{
  return (8. * (f[3 * m] - f[m]) - (f[4 * m] - f[0])) / (12. * h);
}

static PetscReal SecondDifference(PetscInt m, const PetscReal *f, PetscReal h)
{
  return (16. * (f[3 * m] + f[m]) - (f[4 * m] + f[0]) - 30. * f[2 * m]) / (12. * h * h);
}

/* A step that moves no vertex farther than a part of the shortest image edge: b scaled. */
static PetscErrorCode ScaleToMesh(EqmSolver solver, Vec step)
{
  const EqmMesh mesh = solver->mesh;
  const PetscReal *const x = solver->iterate->place.x;
  const PetscInt dim = solver->problem->domain->dim;
  PetscReal shortest = -PETSC_MAX_REAL, largest;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_local_cells; k++) {
    const PetscInt i = mesh->cells[k], j = mesh->cells[k - k % 3 + (k + 1) % 3];
    PetscReal squared = 0.;
    for (PetscInt c = 0; c < dim; c++) squared += PetscSqr(x[dim * i + c] - x[dim * j + c]);
    shortest = PetscMax(shortest, -PetscSqrtReal(squared));
  }
  PetscCall(VecNorm(step, NORM_INFINITY, &largest));
  PetscCall(VecScale(step, .1 * -TestMax(mesh->comm, shortest) / largest));
  PetscFunctionReturn(0);
}

/* lm->descent is minus half the gradient of what EqmLmEvaluate computes. */
static PetscErrorCode TestGradient(EqmSolver solver)
{
  EqmLm *const lm = solver->method->data;
  PetscReal *residual, objective[5], product, norm[2];
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(5 * solver->mesh->num_local_cells, &residual));
  PetscCall(VecDuplicate(lm->descent, &step));
  for (PetscInt seed = 0; seed < 3; seed++) {
    PetscCall(TestRandomStep(solver->problem->domain, seed, 1., step));
    if (seed == 2) PetscCall(VecCopy(lm->descent, step));
    PetscCall(ScaleToMesh(solver, step));
    PetscCall(Sample(solver, step, 1e-2, residual, objective));
    PetscCall(VecDot(lm->descent, step, &product));
    PetscCall(VecNorm(lm->descent, NORM_2, &norm[0]));
    PetscCall(VecNorm(step, NORM_2, &norm[1]));
    CHECK_CLOSE(FirstDifference(1, objective, 1e-2), -2. * product, 1e-7, norm[0] * norm[1]);
  }
  CHECK_CLOSE(solver->iterate->gradient_norm, 2. * norm[0], 1e-12, norm[0]);
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree(residual));
  PetscFunctionReturn(0);
}

/* mu d^T M d, the damping of docs/methods.md: per cell (|rho| + .3 sqrt(phi)) (sqrt(3)/2) times the squared
   displacement about its mean. */
static PetscReal Damping(EqmSolver solver, const PetscReal *velocity)
{
  const EqmLm *const lm = solver->method->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt dim = solver->problem->domain->dim;
  PetscReal sum = 0.;

  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < dim; k++) {
      const PetscReal d[3] = {velocity[dim * v[0] + k], velocity[dim * v[1] + k], velocity[dim * v[2] + k]};
      const PetscReal mean = (d[0] + d[1] + d[2]) / 3.;
      squared += PetscSqr(d[0] - mean) + PetscSqr(d[1] - mean) + PetscSqr(d[2] - mean);
    }
    sum += (PetscAbsReal(lm->now.residual[c]) + .3 * PetscSqrtReal(lm->now.squares)) * .5 * PetscSqrtReal(3.) * squared;
  }
  return lm->mu * TestSum(mesh->comm, sum);
}

/* x^T H x from the definition: sum w (d rho)^2 by differences, damping, the terms' matrices. */
static PetscErrorCode QuadraticForm(EqmSolver solver, Vec x, PetscReal *form)
{
  EqmLm *const lm = solver->method->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt m = mesh->num_local_cells;
  PetscReal *residual, *velocity, objective[5], gauss = 0., terms, length, scale;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(5 * m, &residual, solver->problem->domain->dim * mesh->num_local, &velocity));
  PetscCall(VecDuplicate(x, &step));
  PetscCall(VecCopy(x, step));
  PetscCall(ScaleToMesh(solver, step));
  PetscCall(VecNorm(x, NORM_2, &length));
  PetscCall(VecNorm(step, NORM_2, &scale));
  PetscCall(Sample(solver, step, 1e-2, residual, objective));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++)
    gauss += mesh->weight[c] * PetscSqr(FirstDifference(m, residual + c, 1e-2));
  PetscCall(EqmDomainExpand(solver->problem->domain, &lm->now.place, step, velocity));
  PetscCall(TestTermsForm(solver->problem, &lm->now.place, lm->now.image, velocity, &terms));
  *form = TestSum(mesh->comm, gauss) + Damping(solver, velocity) + terms / solver->problem->domain->target_measure;
  *form *= PetscSqr(length / scale);
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree2(residual, velocity));
  PetscFunctionReturn(0);
}

/* With x = H^-1 b, x^T b must be x^T H x; with sums of right-hand sides this fixes the whole matrix. */
static PetscErrorCode TestMatrix(EqmSolver solver)
{
  EqmLm *const lm = solver->method->data;
  PetscReal form, product;
  PetscBool success;
  Vec b[3], x;

  PetscFunctionBegin;
  lm->mu = .03;
  PetscCall(EqmLmFactor(solver->method, &success));
  CHECK(success, "the matrix at the start is not definite");
  PetscCall(EqmLmSolveForStep(solver->method, &success)); /* makes the mean's term, too */
  for (int k = 0; k < 3; k++) {
    PetscCall(VecDuplicate(lm->descent, &b[k]));
    if (k < 2)
      PetscCall(TestRandomStep(solver->problem->domain, 20 + k, 1., b[k]));
    else
      PetscCall(VecWAXPY(b[2], 1., b[0], b[1]));
  }
  PetscCall(VecDuplicate(lm->descent, &x));
  for (int k = 0; k < 3; k++) {
    PetscCall(VecCopy(b[k], x));
    PetscCall(EqmLmApplyInverse(solver->method, x));
    PetscCall(VecDot(x, b[k], &product));
    PetscCall(QuadraticForm(solver, x, &form));
    CHECK_CLOSE(form, product, 1e-6, product);
  }
  for (int k = 0; k < 3; k++) PetscCall(VecDestroy(&b[k]));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

/* Without terms the model promises sum w rho^2 less that of the linearised residual; lm->rho_first is that of the step.
 */
static PetscErrorCode TestPrediction(EqmSolver solver)
{
  EqmLm *const lm = solver->method->data;
  PetscReal predicted, squares;

  PetscFunctionBegin;
  PetscCall(EqmLmPredictedDecrease(solver->method, &predicted));
  CHECK(predicted > 0., "the model promises a decrease of %g", (double)predicted);
  if (solver->problem->terms) PetscFunctionReturn(0);
  for (PetscInt c = 0; c < solver->mesh->num_local_cells; c++) lm->rho_first[c] += lm->now.residual[c];
  if (lm->residual->without_mean) PetscCall(EqmRemoveWeightedMean(solver->mesh, lm->rho_first));
  PetscCall(EqmWeightedSum(solver->mesh, lm->rho_first, 2, &squares));
  CHECK_CLOSE(predicted, lm->now.squares - squares, 1e-9, lm->now.squares);
  PetscFunctionReturn(0);
}

/* Second derivatives of the residuals along the geodesic of the step. */
static PetscErrorCode TestSecondDerivative(EqmSolver solver)
{
  EqmLm *const lm = solver->method->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt m = mesh->num_local_cells;
  PetscReal *residual, *second, objective[5], ratio, length, scale, largest = 0.;
  PetscBool success;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(5 * m, &residual, m, &second));
  PetscCall(EqmLmFactor(solver->method, &success));
  PetscCall(EqmLmSolveForStep(solver->method, &success));
  PetscCall(EqmLmSolveForCurve(solver->method, &ratio, &success));
  CHECK(success, "no curve");
  PetscCall(PetscArraycpy(second, lm->rho_second, m));
  PetscCall(TestPrediction(solver));
  PetscCall(VecDuplicate(lm->step, &step));
  PetscCall(VecCopy(lm->step, step));
  PetscCall(ScaleToMesh(solver, step));
  PetscCall(VecNorm(lm->step, NORM_2, &length));
  PetscCall(VecNorm(step, NORM_2, &scale));
  PetscCall(Sample(solver, step, 1e-2, residual, objective));
  for (PetscInt c = 0; c < m; c++) largest = PetscMax(largest, PetscAbsReal(second[c]));
  largest = TestMax(mesh->comm, largest);
  CHECK(largest > 0. && ratio > 0., "no second derivative");
  for (PetscInt c = 0; c < m; c++) { /* at ratio one the mixed residual has a kink: leave out what crosses it */
    const PetscReal *const f = residual + c;
    if (!lm->residual->without_mean && (f[0] > 0.) != (f[4 * m] > 0.)) continue;
    CHECK_CLOSE(SecondDifference(m, f, 1e-2) * PetscSqr(length / scale), second[c], 1e-4, largest);
  }
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree2(residual, second));
  PetscFunctionReturn(0);
}

/* Places of the owned vertices after six iterations from a guarded start moved at random by `shift`. */
static PetscErrorCode MapFrom(EqmMesh mesh, PetscReal shift, PetscReal *x)
{
  const PetscInt n = 2 * mesh->num_owned;
  PetscOptions options;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestSolve(mesh, "disk", "-method lm -max_it 0", &solver));
  PetscCall(PetscArraycpy(x, solver->iterate->place.x, n));
  PetscCall(EqmSolverDestroy(&solver));
  for (PetscInt k = 0; k < n; k++) {
    if (!mesh->on_boundary[k / 2]) x[k] += shift * TestRandom(4, mesh->vertex_input[k / 2], k % 2);
  }
  PetscCall(EqmSolverCreate(mesh, "disk", &solver));
  PetscCall(TestOptionsBegin("-method lm -lm_inner 0 -max_it 6 -energy_rtol 0 -quiet", &options));
  PetscCall(EqmSolverSetFromOptions(solver));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(EqmSolverSetFirstMap(solver, 2, x));
  PetscCall(EqmSolverSolve(solver));
  PetscCall(PetscArraycpy(x, solver->iterate->place.x, n));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Without quasi-Newton steps differences between two starts are handed on, not magnified: that is what makes
   registrations of copies meet. */
static PetscErrorCode TestMagnification(void)
{
  const PetscReal shift = 1e-10;
  PetscReal *x, *moved, most = 0.;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 2000, 3, &test));
  PetscCall(PetscMalloc2(2 * test.mesh->num_owned, &x, 2 * test.mesh->num_owned, &moved));
  PetscCall(MapFrom(test.mesh, 0., x));
  PetscCall(MapFrom(test.mesh, shift, moved));
  for (PetscInt k = 0; k < 2 * test.mesh->num_owned; k++) most = PetscMax(most, PetscAbsReal(moved[k] - x[k]));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &most, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  CHECK(most < 1e3 * shift, "%g from starts that are %g apart", (double)most, (double)shift);
  PetscCall(PetscFree2(x, moved));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestTarget(const char *shape, const char *target, const char *options, PetscBool landmarks)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 300, 1, &test));
  PetscCall(Begin(test.mesh, target, options, landmarks, &solver));
  PetscCall(TestGradient(solver));
  PetscCall(TestMatrix(solver));
  PetscCall(TestSecondDerivative(solver));
  PetscCall(End(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestTarget("hills", "disk", "", PETSC_FALSE));
  PetscCall(TestTarget("cap", "disk", "-balance .05", PETSC_FALSE));
  PetscCall(TestTarget("hills", "disk", "-lm_residual ratio", PETSC_FALSE));
  PetscCall(TestTarget("hills", "disk", "-lm_residual mixed", PETSC_FALSE));
  PetscCall(TestTarget("patch", "square", "", PETSC_FALSE));
  PetscCall(TestTarget("hills", "square", "-balance .02", PETSC_FALSE));
  PetscCall(TestTarget("head", "sphere", "", PETSC_FALSE));
  PetscCall(TestTarget("head", "sphere", "-balance .05", PETSC_TRUE));
  PetscCall(TestTarget("hills", "disk", "", PETSC_TRUE));
  PetscCall(TestTarget("cap", "disk", "-balance .05", PETSC_TRUE));
  PetscCall(TestTarget("head", "sphere", "", PETSC_TRUE));
  PetscCall(TestMagnification());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
