/* Whole runs through the C interface: the same map on any number of ranks, the same bits for any number of threads, no
   folds, falling objective, reasons to stop. */
#include "support/runs.h"

/* Every method ends without folds; the history tells of every iteration; guarded methods never let the energy rise. */
static PetscErrorCode TestHistory(const char *shape, const char *target, const char *options, PetscBool monotone)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 600, 3, &test));
  PetscCall(TestSolve(test.mesh, target, options, &solver));
  CHECK(solver->iterate->totals.folds == 0, "%s %s: %d folds", shape, options, (int)solver->iterate->totals.folds);
  CHECK(solver->num_history == solver->iterate->number + 1 && solver->iterate->number > 0, "%d rows for %d iterations",
        (int)solver->num_history, (int)solver->iterate->number);
  for (PetscInt k = 0; k < solver->num_history; k++) {
    const EqmHistoryRow *const row = &solver->history[k];
    CHECK(row->iteration == k, "row %d is of iteration %d", (int)k, (int)row->iteration);
    if (k == 0) continue;
    CHECK(row->step > 0. && row->seconds >= row[-1].seconds && row->work.evaluations >= row[-1].work.evaluations,
          "row %d", (int)k);
    CHECK(!monotone || solver->objectives[k] < solver->objectives[k - 1], "%s %s: iteration %d goes up from %g to %g",
          shape, options, (int)k, (double)solver->objectives[k - 1], (double)solver->objectives[k]);
  }
  CHECK(solver->history[solver->iterate->number].energy == solver->iterate->totals.energy,
        "the last row is not the last map's");
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Why a run stopped. */
static PetscErrorCode TestStops(const char *options, EqmStatus status, const char *word)
{
  static TestMesh test;
  EqmSolver solver;
  PetscBool is_named = PETSC_FALSE;
  char *found;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 400, 1, &test));
  PetscCall(TestSolve(test.mesh, "disk", options, &solver));
  CHECK(solver->status == status, "%s: status %d, not %d: %s", options, (int)solver->status, (int)status,
        solver->message);
  PetscCall(PetscStrstr(solver->message, word, &found));
  is_named = (PetscBool)(found != NULL);
  CHECK(is_named, "%s: '%s' does not mention %s", options, solver->message, word);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* A plain grid of nx x ny vertices, two triangles to a square, all diagonals one way: at two of its corners a triangle
   has all its vertices on the boundary, and is flat in every map that takes them to one side. */
static PetscErrorCode SolveGrid(PetscInt nx, PetscInt ny)
{
  PetscReal *points;
  PetscInt *corners, num = 0;
  EqmSoup soup;
  TestMesh test;
  EqmSolver solver;
  const EqmImageTotals *totals;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * nx * ny, &points, 6 * (nx - 1) * (ny - 1), &corners));
  for (PetscInt k = 0; k < nx * ny; k++) {
    points[3 * k] = (PetscReal)(k % nx);
    points[3 * k + 1] = (PetscReal)(k / nx);
    points[3 * k + 2] = 0.;
  }
  for (PetscInt j = 0; j + 1 < ny; j++) {
    for (PetscInt i = 0; i + 1 < nx; i++) {
      const PetscInt a = nx * j + i, cell[6] = {a, a + 1, a + nx + 1, a, a + nx + 1, a + nx};
      for (PetscInt k = 0; k < 6; k++) corners[num++] = cell[k];
    }
  }
  PetscCall(TestSoupFromArrays(PETSC_COMM_WORLD, nx * ny, points, 3, num / 3, corners, &soup));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestSolve(test.mesh, "square", "", &solver));
  PetscCall(EqmSolverGetTotals(solver, &totals));
  CHECK(totals->folds == 0 && totals->energy < 1e-6, "grid of %d x %d: energy %g, %d folds", (int)nx, (int)ny,
        (double)totals->energy, (int)totals->folds);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(PetscFree2(points, corners));
  PetscFunctionReturn(0);
}

/* Calls out of order are refused with the order that is right, not with a crash. */
static PetscErrorCode TestOrder(EqmMesh mesh)
{
  EqmSolver solver;
  const EqmImageTotals *totals;
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(EqmSolverCreate(mesh, "disk", &solver));
  CHECK_FAILS(PETSC_ERR_ORDER, EqmSolverGetTotals(solver, &totals));
  CHECK_FAILS(PETSC_ERR_ORDER, EqmSolverGetDomain(solver, &domain));
  PetscCall(EqmSolverSetTolerances(solver, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 1));
  PetscCall(EqmSolverSolve(solver)); /* without options */
  CHECK_FAILS(PETSC_ERR_ORDER, EqmSolverSetMethod(solver, "ncg"));
  CHECK_FAILS(PETSC_ERR_ORDER, EqmSolverSetFromOptions(solver));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSameOnRanks("hills", 600, "disk", "-method fixed-point -max_it 10 -energy_rtol 0", 1e-9, .5));
  PetscCall(TestSameOnRanks("hills", 600, "square", "-method fixed-point -max_it 10 -energy_rtol 0", 1e-9, .5));
  PetscCall(TestSameOnRanks("cap", 600, "disk", "-method ncg -max_it 20 -energy_rtol 0", 1e-7, .5));
  PetscCall(TestSameOnRanks("hills", 600, "square", "-method ncg -ncg_refresh 8 -max_it 20 -energy_rtol 0", 1e-7, .5));
  PetscCall(TestSameOnRanks("hills", 600, "disk", "-method lm -max_it 6 -energy_rtol 0", 1e-6, .5));
  PetscCall(TestSameOnRanks("hills", 600, "square", "-method lm -balance .02 -max_it 8 -energy_rtol 0", 1e-6, .5));

  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "hills", 1600, "disk", "-method fixed-point -max_it 3"));
  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "hills", 1600, "square", "-method ncg -max_it 6"));
  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "hills", 1600, "disk", "-method lm -max_it 4"));
  PetscCall(TestSameWithThreads(PETSC_COMM_WORLD, "hills", 1600, "disk", "-method lm -balance .05 -max_it 4"));

  PetscCall(TestHistory("cap", "disk", "-method fixed-point -max_it 20", PETSC_FALSE));
  PetscCall(TestHistory("cap", "disk", "-method ncg -max_it 30", PETSC_TRUE));
  PetscCall(TestHistory("cap", "disk", "-method ncg -ncg_beta polak-ribiere -max_it 30", PETSC_TRUE));
  PetscCall(TestHistory("cap", "disk", "-method ncg -ncg_beta hager-zhang -max_it 30", PETSC_TRUE));
  PetscCall(TestHistory("hills", "disk", "-method lm -max_it 12", PETSC_TRUE));
  PetscCall(TestHistory("hills", "square", "-method lm -max_it 12", PETSC_TRUE));

  PetscCall(TestStops("-method lm -energy_target 1e-3", EQM_STATUS_CONVERGED, "target"));
  PetscCall(TestStops("-method fixed-point -gradient_tol 0 -energy_rtol .5", EQM_STATUS_CONVERGED, "fell"));
  PetscCall(TestStops("-method ncg -gradient_tol 100", EQM_STATUS_CONVERGED, "gradient"));
  PetscCall(TestStops("-method lm -max_it 1 -energy_rtol 0", EQM_STATUS_NOT_CONVERGED, "-max_it"));
  PetscCall(
      TestStops("-method lm -max_factorizations 2 -energy_rtol 0", EQM_STATUS_NOT_CONVERGED, "-max_factorizations"));
  PetscCall(TestStops("-method ncg -wall_time 1e-6 -energy_rtol 0", EQM_STATUS_NOT_CONVERGED, "-wall_time"));

  PetscCall(SolveGrid(5, 3));
  PetscCall(SolveGrid(9, 5));
  PetscCall(SolveGrid(2, 2)); /* every vertex a corner */

  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 100, 1, &test));
  PetscCall(TestOrder(test.mesh));
  PetscCall(TestRefused(test.mesh, "disk", "-method nosuch"));
  PetscCall(TestRefused(test.mesh, "disk", "-start nosuch"));
  PetscCall(TestRefused(test.mesh, "disk", "-max_it -5"));
  PetscCall(TestRefused(test.mesh, "disk", "-wall_time -1"));
  PetscCall(TestRefused(test.mesh, "disk", "-balance -.5"));
  PetscCall(TestRefused(test.mesh, "square", "-corners 1,2,3"));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
