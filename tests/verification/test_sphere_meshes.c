/* The default method on closed surfaces of all kinds: smooth, folded, with ears, with thin legs. Takes minutes. Runs on
   the meshes that a folder named by EQUIMAP_DATA has; without any it is skipped. */
#include "support/published.h"

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

static PetscErrorCode TestPromise(const Promise *promise, EqmSoup soup)
{
  PetscReal energy, sd;
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s ", promise->file));
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestRow(test.mesh, "sphere", promise->options, &energy, &sd));
  CHECK(energy <= promise->most, "%s: energy %g", promise->file, (double)energy);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscInt count = 0;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(promises); k++) {
    EqmSoup soup;
    PetscCall(TestReadPublished(promises[k].file, &soup));
    if (!soup) continue;
    PetscCall(TestPromise(&promises[k], soup));
    count++;
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(count ? 0 : SKIPPED);
}
