/* Levenberg-Marquardt without a factor: steps by conjugate gradients and multigrid lead where exact ones lead. */
#include "support/testing.h"
#include <string.h>

static PetscErrorCode Solve(EqmMesh mesh, const char *target, const char *linear, PetscReal *energy)
{
  EqmSolver solver;
  char options[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "-max_it 3 -linear_solver %s", linear));
  PetscCall(TestSolve(mesh, target, options, &solver));
  CHECK(solver->iterate->totals.folds == 0, "%d folds", (int)solver->iterate->totals.folds);
  CHECK(strstr(solver->problem->linear_solver, linear) || strcmp(linear, "multigrid"), "it was %s",
        solver->problem->linear_solver);
  *energy = solver->iterate->totals.energy;
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestTarget(const char *shape, const char *target)
{
  TestMesh test;
  PetscReal exact, inexact;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 800, 4, &test));
  PetscCall(Solve(test.mesh, target, "auto", &exact));
  PetscCall(EqmLedgerGetWork(test.ledger, &work));
  CHECK(work->cg_iterations == 0, "%d iterations with a factor", (int)work->cg_iterations);
  PetscCall(Solve(test.mesh, target, "multigrid", &inexact));
  CHECK(work->cg_iterations > 0, "no iterations without a factor");
  CHECK(inexact < 3. * exact, "%s: energy %g by iteration, %g by factors", target, (double)inexact, (double)exact);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestTarget("hills", "disk"));
  PetscCall(TestTarget("head", "sphere"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
