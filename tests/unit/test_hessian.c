/* Smallest eigenvalues of the Hessian against those of a dense matrix of differences of gradients. */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

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
  /* quasi-Newton steps would magnify rounding, which depends on the ranks */
  PetscCall(PetscSNPrintf(options, sizeof(options), "-energy_rtol 0 -lm_inner 0 -max_it %d", (int)max_it));
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

/* E_S = area^2 / w of a triangle moved by h in two of its nine coordinates. */
static PetscReal MovedStretch(const PetscReal x[9], PetscReal w, int i, PetscReal hi, int j, PetscReal hj)
{
  PetscReal y[9];

  for (int k = 0; k < 9; k++) y[k] = x[k];
  y[i] += hi;
  y[j] += hj;
  return PetscSqr(EqmArea3(y, y + 3, y + 6)) / w;
}

/* The matrix of 001 Appendix B is made of the second differences of E_S. */
static PetscErrorCode TestStretchCell(void)
{
  const PetscReal x[9] = {.1, .2, -.3, 1.1, .4, .2, .3, 1.2, .5}, *const p[3] = {x, x + 3, x + 6}, w = .7, h = 1e-3;
  PetscReal matrix[81];

  PetscFunctionBegin;
  EqmStretchHessian(p, w, matrix);
  for (int i = 0; i < 9; i++) {
    for (int j = 0; j < 9; j++) {
      const PetscReal difference = (MovedStretch(x, w, i, h, j, h) - MovedStretch(x, w, i, h, j, -h) -
                                    MovedStretch(x, w, i, -h, j, h) + MovedStretch(x, w, i, -h, j, -h)) /
                                   (4. * h * h);
      CHECK_CLOSE(matrix[9 * i + j], difference, 2e-5, 1.);
    }
  }
  PetscFunctionReturn(0);
}

/* Its smallest eigenvalues against those of the whole matrix, dense; on one rank and on several. */
static PetscErrorCode TestStretch(void)
{
  PetscReal values[2][WANTED], *matrix, *dense;
  PetscInt found, n;

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    TestMesh test;
    EqmSolver solver;
    PetscCall(TestMeshCreate(k ? PETSC_COMM_WORLD : PETSC_COMM_SELF, "head", 90, 1, &test));
    PetscCall(TestSolve(test.mesh, "sphere", "-method rgd -max_it 5 -energy_rtol 0", &solver));
    PetscCall(EqmSolverStretchHessianEigenvalues(solver, WANTED, values[k], &found));
    CHECK(found == WANTED, "only %d of %d eigenvalues", (int)found, WANTED);
    if (k == 0) {
      const PetscReal *const x = solver->iterate->place.x;
      n = 3 * test.mesh->num_owned;
      PetscCall(PetscCalloc1(n * n, &matrix));
      PetscCall(PetscMalloc1(n, &dense));
      for (PetscInt c = 0; c < test.mesh->num_owned_cells; c++) {
        const PetscInt *const v = test.mesh->cells + 3 * c;
        const PetscReal *const p[3] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]};
        PetscReal cell[81];
        EqmStretchHessian(p, 4. * PETSC_PI * test.mesh->weight[c], cell);
        for (int e = 0; e < 81; e++) matrix[n * (3 * v[e / 27] + e / 9 % 3) + 3 * v[e % 9 / 3] + e % 3] += cell[e];
      }
      PetscCall(Jacobi(n, matrix, dense));
    }
    PetscCall(EqmSolverDestroy(&solver));
    PetscCall(TestMeshDestroy(&test));
  }
  CHECK(dense[0] < 0., "no eigenvalue is negative");
  for (int k = 0; k < WANTED; k++) {
    CHECK_CLOSE(values[0][k], dense[k], 1e-7, dense[n - 1]);
    CHECK_CLOSE(values[1][k], values[0][k], 1e-6, dense[n - 1]);
  }
  PetscCall(PetscFree(matrix));
  PetscCall(PetscFree(dense));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  if (EqmHessianAvailable()) {
    PetscCall(TestStretchCell());
    PetscCall(TestStretch());
    PetscCall(Test("head", "sphere", 0, 0));
    PetscCall(Test("head", "sphere", 60, 3)); /* rotations */
    PetscCall(Test("cap", "disk", 0, 0));
    PetscCall(Test("cap", "disk", 60, 1));
    PetscCall(Test("hills", "square", 0, 0));
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(EqmHessianAvailable() ? 0 : SKIPPED);
}
