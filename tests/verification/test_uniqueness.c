/* Area-preserving maps are many, and which of them comes out depends on the start; with a share of angle energy it does
   not (docs/methods.md, Uniqueness). */
#include "support/testing.h"
#include "geometry/rotation.h"
#include "mesh/mesh_private.h"
#include <string.h>

/* Rms distance of points on the sphere after the best rotation of the first ones, which they have afterwards. */
static PetscReal RmsOnSphere(EqmMesh mesh, PetscReal *x, const PetscReal *y)
{
  PetscReal correlation[9] = {0.}, rotation[9], squares = 0.;

  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < 9; k++) correlation[k] += y[3 * v + k / 3] * x[3 * v + k % 3];
  }
  for (PetscInt k = 0; k < 9; k++) correlation[k] = TestSum(mesh->comm, correlation[k]);
  PetscCallAbort(mesh->comm, EqmBestRotation(3, correlation, rotation));
  EqmRotate(3, rotation, mesh->num_owned, x);
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) squares += PetscSqr(x[k] - y[k]);
  return PetscSqrtReal(TestSum(mesh->comm, squares) / (PetscReal)mesh->num_vertices);
}

/* Rms distance between the maps from two starts, after the best rotation; the larger of the two energies. */
static PetscErrorCode DistanceOfStarts(EqmMesh mesh, const char *target, const char *method, const char *one,
                                       const char *other, PetscReal *distance, PetscReal *energy)
{
  char options[256];
  EqmSolver solver[2];

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    PetscCall(PetscSNPrintf(options, sizeof(options), "%s %s", method, k ? other : one));
    PetscCall(TestSolve(mesh, target, options, &solver[k]));
    CHECK(solver[k]->iterate->totals.folds == 0, "%s: %d folds", options, (int)solver[k]->iterate->totals.folds);
  }
  PetscReal *const x = solver[0]->iterate->place.x, *const y = solver[1]->iterate->place.x;
  *distance = strcmp(target, "sphere") ? TestRmsAfterRotation(mesh, x, y) : RmsOnSphere(mesh, x, y);
  *energy = PetscMax(solver[0]->iterate->totals.energy, solver[1]->iterate->totals.energy);
  for (int k = 0; k < 2; k++) PetscCall(EqmSolverDestroy(&solver[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestShape(const char *shape, PetscInt n, const char *target, const char *other)
{
  const char *const one = "-start guarded";
  PetscReal apart, together, energy[2];
  TestMesh test;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 4, &test));
  PetscCall(DistanceOfStarts(test.mesh, target, "-method lm -balance 0 -max_it 30", one, other, &apart, &energy[0]));
  PetscCall(DistanceOfStarts(test.mesh, target, "-method lm -balance .05 -max_it 60 -energy_rtol 1e-6", one, other,
                             &together, &energy[1]));
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
  PetscCall(TestShape("hills", 800, "disk", "-start tutte -start_steps 0"));
  PetscCall(TestShape("head", 900, "sphere", "-start tutte"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
