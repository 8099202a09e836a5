/* The default method on closed surfaces of all kinds: smooth, folded, with ears, with thin legs. Takes minutes. Runs on
   the meshes that a folder named by EQUIMAP_DATA has; without any it is skipped. */
#include "support/testing.h"
#include <stdlib.h>

enum { SKIPPED = 77 };

/* What is promised of a mesh: no folds and at most this energy with these options. */
typedef struct {
  const char *file, *options;
  PetscReal most;
} Promise;

static const Promise promises[] = {
    {"sphere_david_head.obj", "-energy_rtol 0 -energy_target 1e-15 -max_it 100", 1e-15},
    {"sphere_brain_12k.obj", "-energy_rtol 0 -max_factorizations 12", 1e-3},
    {"sphere_maxplanck_12k.obj", "-energy_rtol 0 -max_factorizations 12", 1e-3},
    {"sphere_ferret_brain_P0.obj", "-energy_rtol 0 -max_factorizations 12", 1e-3},
    {"sphere_bunny_14k.obj", "-energy_rtol 0 -max_factorizations 30", 5e-4},
    {"sphere_horse.obj", "-energy_rtol 0 -max_factorizations 15", 1e-2},
};

static PetscErrorCode TestPromise(const Promise *promise, const char *file)
{
  EqmSoup soup;
  EqmSolver solver;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(EqmSoupRead(PETSC_COMM_WORLD, file, &soup));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestSolve(test.mesh, "sphere", promise->options, &solver));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s %s: energy %.4e, SD %.4e, %d iterations, %d folds\n", promise->file,
                        promise->options, (double)solver->totals.energy, (double)solver->totals.sd,
                        (int)solver->iteration, (int)solver->totals.folds));
  CHECK(solver->totals.folds == 0, "%s: %d folds", promise->file, (int)solver->totals.folds);
  CHECK(solver->totals.energy <= promise->most, "%s: energy %g", promise->file, (double)solver->totals.energy);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  const char *const folder = getenv("EQUIMAP_DATA");
  PetscInt count = 0;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (size_t k = 0; folder && k < PETSC_STATIC_ARRAY_LENGTH(promises); k++) {
    char file[PETSC_MAX_PATH_LEN];
    PetscBool found;
    PetscCall(PetscSNPrintf(file, sizeof(file), "%s/%s", folder, promises[k].file));
    PetscCall(PetscTestFile(file, 'r', &found));
    if (!found) continue;
    PetscCall(TestPromise(&promises[k], file));
    count++;
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(count ? 0 : SKIPPED);
}
