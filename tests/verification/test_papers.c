/* The published rows of the Stanford Bunny and our own figure on it. Runs where EQUIMAP_DATA names a folder
   with disk_stanford_bunny.obj; elsewhere it is skipped. */
#include "support/published.h"

/* Figures of 000 Table 1 where they can be reproduced, of docs/methods.md where they cannot. */
static PetscErrorCode TestRows(EqmMesh mesh)
{
  PetscReal energy, sd;

  PetscFunctionBegin;
  PetscCall(TestRow(mesh, "disk", "-method fixed-point -start harmonic -max_it 100 -energy_rtol 0", &energy, &sd));
  CHECK_CLOSE(energy, 4.775e-3, .01, 4.775e-3);
  CHECK_CLOSE(sd, 3.92e-2, .01, 3.92e-2);
  PetscCall(TestRow(mesh, "disk", "-method ncg -max_it 100 -energy_rtol 0", &energy, &sd));
  CHECK_CLOSE(energy, 1.478e-3, .02, 1.478e-3);
  CHECK_CLOSE(sd, 2.20e-2, .02, 2.20e-2);
  PetscCall(TestRow(mesh, "disk", "-method ncg -ncg_refresh 50 -max_it 100 -energy_rtol 0", &energy, &sd));
  CHECK_CLOSE(energy, 7.93e-4, .03, 7.93e-4);
  CHECK_CLOSE(sd, 1.62e-2, .03, 1.62e-2);
  PetscCall(TestRow(mesh, "disk", "-max_factorizations 12 -energy_rtol 0", &energy, &sd));
  CHECK(energy <= 5e-5, "%g after 12 coupled factorisations", (double)energy);
  PetscFunctionReturn(0);
}

/* With -balance .05 two starts lead to one map (docs/methods.md, Uniqueness). */
static PetscErrorCode TestUniqueness(EqmMesh mesh)
{
  const char *const options[2] = {"-method lm -balance .05 -energy_rtol 1e-6 -start guarded",
                                  "-method lm -balance .05 -energy_rtol 1e-6 -start tutte -start_steps 0"};
  EqmSolver solver[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) PetscCall(TestSolve(mesh, "disk", options[k], &solver[k]));
  const PetscReal distance = TestRmsAfterRotation(mesh, solver[0]->iterate->place.x, solver[1]->iterate->place.x);
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "balanced, two starts: %d and %d iterations, rms distance %.2e\n",
                        (int)solver[0]->iterate->number, (int)solver[1]->iterate->number, (double)distance));
  CHECK(distance <= .006, "the two maps are %g apart", (double)distance);
  for (int k = 0; k < 2; k++) PetscCall(EqmSolverDestroy(&solver[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode Test(EqmSoup soup)
{
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestRows(test.mesh));
  PetscCall(TestUniqueness(test.mesh));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  return TestOnPublished(argc, argv, "disk_stanford_bunny.obj", Test);
}
