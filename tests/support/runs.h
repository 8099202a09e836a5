/* Whole runs, compared: on one rank and on many, with one thread and with two; and runs that are refused. */
#ifndef EQM_TEST_RUNS_H
#define EQM_TEST_RUNS_H

#include "support/testing.h"
#include "mesh/mesh_private.h"
#include <omp.h>
#include <string.h>
#include "store/map_private.h"

/* Run and fetch the map in input numbering. */
static inline PetscErrorCode TestMap(TestMesh *test, const char *target, const char *options, EqmMap *map)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestSolve(test->mesh, target, options, &solver));
  PetscCall(EqmSolverGetMap(solver, test->soup, map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* `alone` is the whole map on this rank. */
static inline PetscErrorCode TestCheckSameMap(EqmMap alone, EqmMap together, PetscReal tolerance, const char *what)
{
  const EqmDistortion *const a = &alone->distortion, *const b = &together->distortion;
  const PetscInt dim = together->dim, first = together->soup->vertex_start, first_cell = together->soup->cell_start;
  PetscReal difference = 0.;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < dim * (together->soup->vertex_end - first); k++)
    difference = PetscMax(difference, PetscAbsReal(together->coordinates[k] - alone->coordinates[dim * first + k]));
  CHECK(difference <= tolerance, "%s: a vertex is %g away from where it is on one rank", what, (double)difference);
  for (PetscInt c = first_cell; c < together->soup->cell_end; c++)
    CHECK_CLOSE(together->cell_ratio[c - first_cell], alone->cell_ratio[c], 100. * tolerance, 1.);
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

/* The mesh on all ranks together and on each alone; the energy must end below `share` of what it was. */
static inline PetscErrorCode TestSameOnRanks(const char *shape, PetscInt n, const char *target, const char *options,
                                             PetscReal tolerance, PetscReal share)
{
  TestMesh test[2];
  EqmMap map[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    PetscCall(TestMeshCreate(k ? PETSC_COMM_WORLD : PETSC_COMM_SELF, shape, n, 1, &test[k]));
    PetscCall(TestMap(&test[k], target, options, &map[k]));
  }
  CHECK(map[0]->energy_final < share * map[0]->energy_initial, "%s %s: energy %g, at the start %g", shape, options,
        (double)map[0]->energy_final, (double)map[0]->energy_initial);
  PetscCall(TestCheckSameMap(map[0], map[1], tolerance, options));
  for (int k = 0; k < 2; k++) {
    PetscCall(EqmMapDestroy(&map[k]));
    PetscCall(TestMeshDestroy(&test[k]));
  }
  PetscFunctionReturn(0);
}

/* Two runs with 1 and 2 threads differ in nothing. On several ranks they do in the last digits, with or without
   threads: MUMPS adds contributions in the order in which they arrive. */
static inline PetscErrorCode TestSameWithThreads(MPI_Comm comm, const char *shape, PetscInt n, const char *target,
                                                 const char *options)
{
  TestMesh test;
  EqmMap map[2];

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(comm, shape, n, 1, &test));
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(k + 1);
    PetscCall(TestMap(&test, target, options, &map[k]));
  }
  omp_set_num_threads(1);
  for (PetscInt k = 0; k < map[0]->dim * (test.soup->vertex_end - test.soup->vertex_start); k++)
    CHECK_CLOSE(map[1]->coordinates[k], map[0]->coordinates[k], test.mesh->size == 1 ? 0. : 1e-7, 1.);
  CHECK(test.mesh->size > 1 || !memcmp(&map[0]->distortion, &map[1]->distortion, sizeof(EqmDistortion)),
        "%s: other figures with two threads", options);
  for (int k = 0; k < 2; k++) PetscCall(EqmMapDestroy(&map[k]));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Options that cannot be satisfied are refused before any work. */
static inline PetscErrorCode TestRefused(EqmMesh mesh, const char *target, const char *text)
{
  PetscOptions options;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(mesh, target, &solver));
  CHECK_FAILS(EQM_ERR_USAGE, EqmSolverSetFromOptions(solver));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

#endif
