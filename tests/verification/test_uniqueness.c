/* Area-preserving maps are many, and which of them comes out depends on the start; with a share of angle energy it does
   not (docs/methods.md, Uniqueness). */
#include "support/testing.h"

/* Rms distance between the maps from two starts, after the best rotation; the larger of the two energies. */
static PetscErrorCode DistanceOfStarts(EqmMesh mesh, const char *method, const char *one, const char *other,
                                       PetscReal *distance, PetscReal *energy)
{
  char options[256];
  EqmSolver solver[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    PetscCall(PetscSNPrintf(options, sizeof(options), "%s %s", method, k ? other : one));
    PetscCall(TestSolve(mesh, "disk", options, &solver[k]));
    CHECK(solver[k]->iterate->totals.folds == 0, "%s: %d folds", options, (int)solver[k]->iterate->totals.folds);
  }
  *distance = TestRmsAfterRotation(mesh, solver[0]->iterate->place.x, solver[1]->iterate->place.x);
  *energy = PetscMax(solver[0]->iterate->totals.energy, solver[1]->iterate->totals.energy);
  for (int k = 0; k < 2; k++) PetscCall(EqmSolverDestroy(&solver[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestShape(const char *shape, PetscInt n)
{
  const char *const one = "-start guarded", *const other = "-start tutte -start_steps 0";
  PetscReal apart, together, energy[2];
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 4, &test));
  PetscCall(DistanceOfStarts(test.mesh, "-method lm -balance 0 -max_it 30", one, other, &apart, &energy[0]));
  PetscCall(DistanceOfStarts(test.mesh, "-method lm -balance .05 -max_it 60 -energy_rtol 1e-6", one, other, &together,
                             &energy[1]));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "%s: from two starts, rms distance %.2e (energy %.1e); balanced %.2e (energy %.1e)\n", shape,
                        (double)apart, (double)energy[0], (double)together, (double)energy[1]));
  CHECK(energy[0] < 1e-4 && apart > .01, "energy %g, distance %g", (double)energy[0], (double)apart);
  CHECK(together < 1e-5, "balanced: %g", (double)together);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestShape("hills", 800));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
