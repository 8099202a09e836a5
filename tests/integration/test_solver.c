/* Whole runs through the C interface: the same map on any number of ranks, the same bits for any number of threads, no
   folds, falling objective, reasons to stop. */
#include "support/testing.h"
#include <omp.h>
#include <string.h>

/* Run and fetch the map in input numbering. */
static PetscErrorCode Map(TestMesh *test, const char *target, const char *options, EqmMap *map)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestSolve(test->mesh, target, options, &solver));
  PetscCall(EqmSolverGetMap(solver, test->soup, map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckSameMap(EqmMap alone, EqmMap together, PetscReal tolerance, const char *what)
{
  const EqmDistortion *const a = &alone->distortion, *const b = &together->distortion;
  const PetscInt first = together->soup->vertex_start;
  PetscReal difference = 0.;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2 * (together->soup->vertex_end - first); k++) {
    difference = PetscMax(difference, PetscAbsReal(together->coordinates[k] - alone->coordinates[2 * first + k]));
  }
  CHECK(difference <= tolerance, "%s: a vertex is %g away from where it is on one rank", what, (double)difference);
  for (PetscInt c = together->soup->cell_start; c < together->soup->cell_end; c++) {
    CHECK_CLOSE(together->cell_ratio[c - together->soup->cell_start], alone->cell_ratio[c], 100. * tolerance, 1.);
  }
  CHECK(a->folds == b->folds && together->iterations == alone->iterations &&
            together->num_history == alone->num_history,
        "%s: %d iterations, alone %d", what, (int)together->iterations, (int)alone->iterations);
  CHECK_CLOSE(b->energy, a->energy, 10. * tolerance, a->energy + tolerance);
  CHECK_CLOSE(b->ratio.sd, a->ratio.sd, 10. * tolerance, 1.);
  CHECK_CLOSE(b->ratio.p95, a->ratio.p95, 10. * tolerance, 1.);
  CHECK_CLOSE(b->angle_error.mean, a->angle_error.mean, 1e3 * tolerance, 1.);
  CHECK_CLOSE(b->mesh_measure, a->mesh_measure, 1e-12, a->mesh_measure);
  PetscFunctionReturn(0);
}

/* The mesh on all ranks together and on each alone. */
static PetscErrorCode TestRanks(const char *shape, const char *target, const char *options, PetscReal tolerance)
{
  TestMesh alone, together;
  EqmMap map_alone, map_together;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, shape, 600, 1, &alone));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 600, 1, &together));
  PetscCall(Map(&alone, target, options, &map_alone));
  PetscCall(Map(&together, target, options, &map_together));
  CHECK(map_alone->distortion.energy < .5 * map_alone->energy_initial, "%s: the energy has not fallen", options);
  PetscCall(CheckSameMap(map_alone, map_together, tolerance, options));
  PetscCall(EqmMapDestroy(&map_alone));
  PetscCall(EqmMapDestroy(&map_together));
  PetscCall(TestMeshDestroy(&alone));
  PetscCall(TestMeshDestroy(&together));
  PetscFunctionReturn(0);
}

/* Two runs with 1 and 2 threads differ in nothing. On several ranks they do in the last digits, with or without
   threads: MUMPS adds contributions in the order in which they arrive. */
static PetscErrorCode TestThreads(const char *target, const char *options)
{
  TestMesh test;
  EqmMap map[2];

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 1600, 1, &test));
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(k + 1);
    PetscCall(Map(&test, target, options, &map[k]));
  }
  omp_set_num_threads(1);
  const PetscInt n = 2 * (test.soup->vertex_end - test.soup->vertex_start);
  for (PetscInt k = 0; k < n; k++)
    CHECK_CLOSE(map[1]->coordinates[k], map[0]->coordinates[k], test.mesh->size == 1 ? 0. : 1e-7, 1.);
  CHECK(test.mesh->size > 1 || !memcmp(&map[0]->distortion, &map[1]->distortion, sizeof(EqmDistortion)),
        "%s: other figures with two threads", options);
  for (int k = 0; k < 2; k++) PetscCall(EqmMapDestroy(&map[k]));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Every method ends without folds; the history tells of every iteration; guarded methods never let the energy rise. */
static PetscErrorCode TestHistory(const char *shape, const char *target, const char *options, PetscBool monotone)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 600, 3, &test));
  PetscCall(TestSolve(test.mesh, target, options, &solver));
  CHECK(solver->totals.folds == 0, "%s %s: %d folds", shape, options, (int)solver->totals.folds);
  CHECK(solver->num_history == solver->iteration + 1 && solver->iteration > 0, "%d rows for %d iterations",
        (int)solver->num_history, (int)solver->iteration);
  for (PetscInt k = 0; k < solver->num_history; k++) {
    const EqmHistoryRow *const row = &solver->history[k];
    CHECK(row->iteration == k, "row %d is of iteration %d", (int)k, (int)row->iteration);
    if (k == 0) continue;
    CHECK(row->step > 0. && row->seconds >= row[-1].seconds && row->work.evaluations >= row[-1].work.evaluations,
          "row %d", (int)k);
    CHECK(!monotone || solver->objectives[k] < solver->objectives[k - 1], "%s %s: iteration %d goes up from %g to %g",
          shape, options, (int)k, (double)solver->objectives[k - 1], (double)solver->objectives[k]);
  }
  CHECK(solver->history[solver->iteration].energy == solver->totals.energy, "the last row is not the last map's");
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Why a run stopped. */
static PetscErrorCode TestStops(const char *options, EqmStatus status, const char *word)
{
  static TestMesh test;
  EqmSolver solver;
  PetscBool said = PETSC_FALSE;
  char *found;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 400, 1, &test));
  PetscCall(TestSolve(test.mesh, "disk", options, &solver));
  CHECK(solver->status == status, "%s: status %d, not %d: %s", options, (int)solver->status, (int)status,
        solver->message);
  PetscCall(PetscStrstr(solver->message, word, &found));
  said = (PetscBool)(found != NULL);
  CHECK(said, "%s: '%s' does not speak of %s", options, solver->message, word);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* What a user gets wrong is told as such, before any work. */
static PetscErrorCode TestUsage(const char *target, const char *text)
{
  TestMesh test;
  PetscOptions options;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 100, 1, &test));
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(test.mesh, target, &solver));
  CHECK_FAILS(EQM_ERR_USAGE, EqmSolverSetFromOptions(solver));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestRanks("hills", "disk", "-method fixed-point -max_it 10 -energy_rtol 0", 1e-9));
  PetscCall(TestRanks("hills", "square", "-method fixed-point -max_it 10 -energy_rtol 0", 1e-9));
  PetscCall(TestRanks("cap", "disk", "-method ncg -max_it 20 -energy_rtol 0", 1e-7));
  PetscCall(TestRanks("hills", "square", "-method ncg -ncg_refresh 8 -max_it 20 -energy_rtol 0", 1e-7));
  PetscCall(TestRanks("hills", "disk", "-method lm -max_it 6 -energy_rtol 0", 1e-6));
  PetscCall(TestRanks("hills", "square", "-method lm -balance .02 -max_it 8 -energy_rtol 0", 1e-6));

  PetscCall(TestThreads("disk", "-method fixed-point -max_it 3"));
  PetscCall(TestThreads("square", "-method ncg -max_it 6"));
  PetscCall(TestThreads("disk", "-method lm -max_it 4"));
  PetscCall(TestThreads("disk", "-method lm -balance .05 -max_it 4"));

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

  PetscCall(TestUsage("disk", "-method nosuch"));
  PetscCall(TestUsage("disk", "-start nosuch"));
  PetscCall(TestUsage("disk", "-max_it -5"));
  PetscCall(TestUsage("disk", "-wall_time -1"));
  PetscCall(TestUsage("disk", "-balance -.5"));
  PetscCall(TestUsage("square", "-corners 1,2,3"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
