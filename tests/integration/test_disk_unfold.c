/* Angle-preserving maps to the disk of surfaces with many obtuse triangles: the harmonic map folds, the one that is
   kept does not. */
#include "support/runs.h"

static PetscErrorCode TestHills(const char *options, EqmStatus status)
{
  TestMesh test;
  EqmSolver solver;
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 800, 1, &test));
  PetscCall(TestSolve(test.mesh, "conformal", options, &solver));
  CHECK(solver->iterate->unfolded_from > 5, "only %d folds: nothing is tested", (int)solver->iterate->unfolded_from);
  CHECK(solver->iterate->unfolded_to == 0 && solver->iterate->totals.folds == 0, "%d and %d folds are left",
        (int)solver->iterate->unfolded_to, (int)solver->iterate->totals.folds);
  CHECK(solver->iterate->totals.smallest > 0., "smallest image %g", (double)solver->iterate->totals.smallest);
  CHECK(solver->status == status, "status %d: %s", (int)solver->status, solver->message);
  PetscCall(EqmDomainBoundaryInOrder(solver->problem->domain, &solver->iterate->place, &in_order));
  CHECK(in_order, "the boundary is not in its order");
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestHills("", EQM_STATUS_CONVERGED));
  PetscCall(TestHills("-method qiem -max_it 5", EQM_STATUS_NOT_CONVERGED));
  /* it begins with harmonic measure, close to the end; what folds cost, as they are mended, is more than the rest */
  PetscCall(TestSameOnRanks("hills", 800, "conformal", "", 1e-7, 1.001));
  PetscCall(TestSameWithThreads(PETSC_COMM_SELF, "hills", 800, "conformal", ""));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
