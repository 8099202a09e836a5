/* Smallest eigenvalues of the Hessian against those of a dense matrix of differences of gradients. */
#include "support/testing.h"
#include "domain/domain_private.h"

enum { SKIPPED = 77, WANTED = 12 };

/* The gradient at parameter t of the geodesic of one degree of freedom, in the carried frames: there its derivative by
   t is a column of the Hessian. */
static PetscErrorCode GradientAlong(EqmSolver solver, PetscInt dof, PetscReal t, PetscReal *gradient)
{
  const PetscScalar *g;
  PetscReal *a, energy;
  EqmPlace to;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &a));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &to));
  PetscCall(EqmDomainCreateVec(solver->problem->domain, &step));
  PetscCall(VecSet(step, 0.));
  PetscCall(VecSetValue(step, dof, t, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(step));
  PetscCall(VecAssemblyEnd(step));
  PetscCall(EqmDomainMove(solver->problem->domain, &solver->iterate->place, 1., step, &to));
  PetscCall(EqmAuthalicEnergy(solver->problem->domain, &to, a, &energy, step));
  PetscCall(VecGetArrayRead(step, &g));
  PetscCall(PetscArraycpy(gradient, g, solver->problem->domain->num_dofs));
  PetscCall(VecRestoreArrayRead(step, &g));
  PetscCall(VecDestroy(&step));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(PetscFree(a));
  PetscFunctionReturn(0);
}

/* Eigenvalues of a symmetric matrix, which is used up, by Jacobi's rotations; ascending. */
static PetscErrorCode Jacobi(PetscInt n, PetscReal *m, PetscReal *eigenvalues)
{
  PetscFunctionBegin;
  for (int sweep = 0; sweep < 12; sweep++) {
    for (PetscInt p = 0; p < n; p++) {
      for (PetscInt q = 0; q < p; q++) {
        const PetscReal angle = .5 * PetscAtan2Real(2. * m[n * p + q], m[n * q + q] - m[n * p + p]);
        const PetscReal c = PetscCosReal(angle), s = PetscSinReal(angle);
        for (PetscInt k = 0; k < n; k++) {
          const PetscReal a = m[n * p + k], b = m[n * q + k];
          m[n * p + k] = c * a - s * b;
          m[n * q + k] = s * a + c * b;
        }
        for (PetscInt k = 0; k < n; k++) {
          const PetscReal a = m[n * k + p], b = m[n * k + q];
          m[n * k + p] = c * a - s * b;
          m[n * k + q] = s * a + c * b;
        }
      }
    }
  }
  for (PetscInt k = 0; k < n; k++) eigenvalues[k] = m[n * k + k];
  PetscCall(PetscSortReal(n, eigenvalues));
  PetscFunctionReturn(0);
}

/* All eigenvalues, ascending, of the Hessian by differences of fourth order. On one rank. */
static PetscErrorCode DenseEigenvalues(EqmSolver solver, PetscReal *eigenvalues)
{
  const PetscInt n = solver->problem->domain->num_dofs;
  const PetscReal h = 1e-3;
  PetscReal *matrix, *gradient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n * n, &matrix, 4 * n, &gradient));
  for (PetscInt j = 0; j < n; j++) {
    for (int k = 0; k < 4; k++) PetscCall(GradientAlong(solver, j, (k < 2 ? k - 2 : k - 1) * h, gradient + k * n));
    for (PetscInt i = 0; i < n; i++)
      matrix[n * j + i] =
          (8. * (gradient[2 * n + i] - gradient[n + i]) - (gradient[3 * n + i] - gradient[i])) / (12. * h);
  }
  PetscCall(Jacobi(n, matrix, eigenvalues));
  PetscCall(PetscFree2(matrix, gradient));
  PetscFunctionReturn(0);
}

/* All ranks together and each alone find the same; alone it is the dense matrix's, too. */
static PetscErrorCode Test(const char *shape, const char *target, PetscInt max_it, PetscInt num_zero)
{
  PetscReal values[2][WANTED], *dense, largest;
  PetscInt found[2], n;
  char options[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "-energy_rtol 0 -max_it %d", (int)max_it));
  for (int k = 0; k < 2; k++) {
    TestMesh test;
    EqmSolver solver;
    PetscCall(TestMeshCreate(k ? PETSC_COMM_WORLD : PETSC_COMM_SELF, shape, 90, 1, &test));
    PetscCall(TestSolve(test.mesh, target, options, &solver));
    PetscCall(EqmSolverHessianEigenvalues(solver, WANTED, values[k], &found[k]));
    CHECK(found[k] == WANTED, "only %d of %d eigenvalues", (int)found[k], WANTED);
    if (k == 0) {
      n = solver->problem->domain->num_dofs;
      PetscCall(PetscMalloc1(n, &dense));
      PetscCall(DenseEigenvalues(solver, dense));
      CHECK_FAILS(EQM_ERR_USAGE, EqmSolverHessianEigenvalues(solver, n + 1, dense, &found[1]));
    }
    PetscCall(EqmSolverDestroy(&solver));
    PetscCall(TestMeshDestroy(&test));
  }
  largest = dense[n - 1];
  CHECK(max_it > 0 || dense[0] < -1e-3 * largest, "no eigenvalue is negative at the start");
  for (int k = 0; k < WANTED; k++) {
    CHECK_CLOSE(values[0][k], dense[k], 1e-8, largest);
    CHECK_CLOSE(values[1][k], values[0][k], 1e-7, largest);
  }
  for (int k = 0; k < num_zero; k++) CHECK_CLOSE(values[0][k], 0., 1e-7, largest);
  PetscCall(PetscFree(dense));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  if (EqmHessianAvailable()) {
    PetscCall(Test("head", "sphere", 0, 0));
    PetscCall(Test("head", "sphere", 20, 3)); /* rotations */
    PetscCall(Test("cap", "disk", 0, 0));
    PetscCall(Test("cap", "disk", 20, 1));
    PetscCall(Test("hills", "square", 0, 0));
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(EqmHessianAvailable() ? 0 : SKIPPED);
}
