/* The barrier against folds of maps to the ball: its derivatives, what it adds to the metric, what it counts. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "problem/barrier.h"
#include "solver/solver_private.h"

/* One cell's function against differences, on both sides of a fold. */
static void TestTerm(EqmBarrier barrier)
{
  static const PetscReal ratios[] = {-3., -.4, -1e-2, 0., 1e-2, .3, 1., 5.}, h = 1e-4;

  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(ratios); k++) {
    const EqmBarrierTerm at = EqmBarrierOfCell(barrier, ratios[k], 2.);
    const EqmBarrierTerm up = EqmBarrierOfCell(barrier, ratios[k] + h, 2.),
                         down = EqmBarrierOfCell(barrier, ratios[k] - h, 2.);
    const PetscReal scale = PetscAbsReal(at.value) + PetscAbsReal(at.first) + PetscAbsReal(at.second);
    CHECK_CLOSE((up.value - down.value) / (2. * h), at.first, 1e-5, scale);
    CHECK_CLOSE((up.first - down.first) / (2. * h), at.second, 1e-5, scale);
    CHECK_CLOSE(EqmBarrierOfCell(barrier, ratios[k], 3.).value - at.value, at.by_stretch, 1e-12, scale);
  }
}

static PetscErrorCode ValueAt(EqmSolver solver, EqmBarrier barrier, const EqmPlace *from, Vec step, PetscReal t,
                              PetscReal *value, Vec gradient)
{
  PetscReal *image;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &image));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &to));
  PetscCall(EqmDomainMove(solver->problem->domain, from, t, step, &to));
  PetscCall(EqmImageMeasure(solver->problem->domain, &to, image));
  *value = 0.;
  PetscCall(barrier->term.add(&barrier->term, solver->problem, &to, image, value, gradient));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(PetscFree(image));
  PetscFunctionReturn(0);
}

/* The gradient's product with a random direction against differences of fourth order. */
static PetscErrorCode TestGradient(EqmSolver solver, EqmBarrier barrier)
{
  const PetscReal h = 1e-4;
  PetscReal value[4], slope, length;
  Vec gradient, step;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(solver->problem->domain, &gradient));
  PetscCall(VecDuplicate(gradient, &step));
  PetscCall(VecZeroEntries(gradient));
  PetscCall(TestRandomStep(solver->problem->domain, 3, 1., step));
  PetscCall(ValueAt(solver, barrier, &solver->iterate->place, step, 0., &value[0], gradient));
  PetscCall(VecDot(gradient, step, &slope));
  PetscCall(VecNorm(gradient, NORM_2, &length));
  for (int k = 0; k < 4; k++)
    PetscCall(ValueAt(solver, barrier, &solver->iterate->place, step, (k < 2 ? k - 2 : k - 1) * h, &value[k], NULL));
  CHECK(length > 0., "no gradient");
  CHECK_CLOSE((value[0] - 8. * value[1] + 8. * value[2] - value[3]) / (12. * h), slope, 1e-6, PetscAbsReal(slope));
  PetscCall(VecDestroy(&gradient));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

/* A cell's matrix is symmetric and nowhere negative, and scales with the barrier. */
static PetscErrorCode TestMatrix(EqmSolver solver, EqmBarrier barrier)
{
  PetscReal largest = 0.;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < solver->mesh->num_local_cells; c++) {
    EqmCellFrame frame;
    PetscReal matrix[144] = {0.}, product = 0., trace = 0.;
    PetscInt n = 0;
    EqmCellFrameFind(solver->problem->domain, &solver->iterate->place, c, &frame);
    barrier->term.add_matrix(&barrier->term, solver->problem, &solver->iterate->place, solver->iterate->image, c,
                             &frame, 1., matrix);
    for (PetscInt a = 0; a < 4; a++) n += solver->problem->domain->dof_count[solver->mesh->cells[4 * c + a]];
    for (PetscInt i = 0; i < n; i++) {
      trace += matrix[n * i + i];
      for (PetscInt j = 0; j < n; j++) {
        CHECK_CLOSE(matrix[n * i + j], matrix[n * j + i], 1e-12, matrix[n * i + i] + matrix[n * j + j]);
        product += matrix[n * i + j] * TestRandom(1, c, i) * TestRandom(1, c, j);
      }
    }
    CHECK(product >= -1e-12 * trace, "cell %d: %g of %g", (int)c, (double)product, (double)trace);
    largest = PetscMax(largest, trace);
  }
  CHECK(TestMax(solver->comm, largest) > 0., "nothing is added");
  PetscFunctionReturn(0);
}

/* Boundary vertices moved where they may go, the others anywhere, until something folds. */
static PetscErrorCode Shake(EqmSolver solver)
{
  const EqmDomain domain = solver->problem->domain;
  Vec step;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(domain, &step));
  PetscCall(TestRandomStep(domain, 5, domain->target_measure > 1. ? .05 : .03, step));
  PetscCall(EqmDomainMove(domain, &solver->iterate->place, 1., step, &solver->iterate->place));
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestTarget(EqmMesh mesh, const char *target)
{
  EqmSolver solver;
  EqmBarrier barrier;
  PetscReal least;
  PetscInt64 folds, inside, outside;

  PetscFunctionBegin;
  PetscCall(TestSolve(mesh, target, "-max_it 0", &solver));
  PetscCall(Shake(solver));
  PetscCall(EqmBarrierCreate(solver->problem, &solver->iterate->place, &barrier));
  barrier->weight = .3;
  barrier->shape_weight = .2;
  barrier->epsilon = .1;
  TestTerm(barrier);
  PetscCall(TestGradient(solver, barrier));
  PetscCall(TestMatrix(solver, barrier));
  PetscCall(EqmBarrierInspect(barrier, solver->problem, solver->iterate, &least, &folds));
  inside = solver->iterate->totals.folds;
  PetscCall(EqmImageBoundaryFolds(solver->problem->domain, &solver->iterate->place, &outside));
  CHECK(folds == inside + outside && (folds > 0) == (least <= 0.), "%d folds, %d and %d, least %g", (int)folds,
        (int)inside, (int)outside, (double)least);
  PetscCall(EqmBarrierDestroy(&barrier));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "ball", 400, 3, &test));
  PetscCall(TestTarget(test.mesh, "ball"));
  PetscCall(TestTarget(test.mesh, "cube"));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
