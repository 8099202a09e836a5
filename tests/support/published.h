/* Meshes that papers and promises speak of: in a folder that EQUIMAP_DATA names, or not to be had. */
#ifndef EQM_TEST_PUBLISHED_H
#define EQM_TEST_PUBLISHED_H

#include "support/testing.h"
#include "mesh/mesh_private.h"
#include <stdlib.h>

/* The exit code of a test that had nothing to test. */
enum { SKIPPED = 77 };

/* NULL where the file is not there. */
static inline PetscErrorCode TestReadPublished(const char *name, EqmSoup *soup)
{
  const char *const folder = getenv("EQUIMAP_DATA");
  char file[PETSC_MAX_PATH_LEN];
  PetscBool found = PETSC_FALSE;

  PetscFunctionBegin;
  *soup = NULL;
  PetscCall(PetscSNPrintf(file, sizeof(file), "%s/%s", folder ? folder : "", name));
  if (folder) PetscCall(PetscTestFile(file, 'r', &found));
  if (found) PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, soup));
  PetscFunctionReturn(0);
}

/* One run with its figures printed; it must not fold. */
static inline PetscErrorCode TestRow(EqmMesh mesh, const char *target, const char *options, PetscReal *energy,
                                     PetscReal *sd)
{
  EqmSolver solver;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  *work = (EqmWork){0}; /* -max_factorizations counts those of the ledger */
  PetscCall(TestSolve(mesh, target, options, &solver));
  *energy = solver->iterate->totals.energy;
  *sd = solver->iterate->totals.sd;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: energy %.4e, SD %.4e, %d iterations, %d folds\n", options,
                        (double)*energy, (double)*sd, (int)solver->iterate->number,
                        (int)solver->iterate->totals.folds));
  CHECK(solver->iterate->totals.folds == 0, "%s: %d folds", options, (int)solver->iterate->totals.folds);
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* A test's main: `test` takes the mesh over; without it the test is skipped, by its exit code. */
static inline int TestOnPublished(int argc, char **argv, const char *name, PetscErrorCode (*test)(EqmSoup))
{
  EqmSoup soup;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestReadPublished(name, &soup));
  if (soup) PetscCall(test(soup));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(soup ? 0 : SKIPPED);
}

#endif
