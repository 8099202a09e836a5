/* A rectangle rolled on a cylinder is flat inside: unrolled, and scaled along its sides, it fills the square exactly,
   with equal ratios; and that map is the minimiser of the angle energy with sliding sides, too. */
#include "support/testing.h"
#include "mesh/mesh_private.h"

/* Where the exact map takes a point of the generated patch: 4 radians by 3, corners to corners. */
static void Unroll(const PetscReal *p, PetscReal *x)
{
  PetscReal angle = PetscAtan2Real(p[1], p[0]);

  if (angle < -1e-9) angle += 2. * PETSC_PI;
  x[0] = angle / 4.;
  x[1] = p[2] / 3.;
}

/* Input numbers of the four corners, in the order of (0,0), (1,0), (1,1), (0,1). */
static PetscErrorCode Corners(EqmMesh mesh, PetscInt corners[4])
{
  PetscInt mine[4] = {-1, -1, -1, -1};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal x[2];
    Unroll(mesh->position + 3 * v, x);
    for (PetscInt k = 0; k < 4; k++) {
      const PetscReal wanted[2] = {k == 1 || k == 2, k >= 2};
      if (PetscAbsReal(x[0] - wanted[0]) + PetscAbsReal(x[1] - wanted[1]) < 1e-9) mine[k] = mesh->vertex_input[v];
    }
  }
  PetscCall(MPIU_Allreduce(mine, corners, 4, MPIU_INT, MPI_MAX, mesh->comm));
  for (PetscInt k = 0; k < 4; k++) CHECK(corners[k] >= 0, "corner %d is not found", (int)k);
  PetscFunctionReturn(0);
}

/* Energy of the exact map at the vertices; rms and largest distance of the solver's map from it. */
static PetscErrorCode Compare(PetscInt n, const char *method, PetscReal *energy, PetscReal *rms, PetscReal *largest)
{
  char options[256];
  TestMesh test;
  EqmSolver solver;
  EqmPlace exact;
  PetscReal *a, sum = 0., most = 0.;
  PetscInt c[4];

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "patch", n, 1, &test));
  PetscCall(Corners(test.mesh, c));
  PetscCall(PetscSNPrintf(options, sizeof(options), "%s -corners %d,%d,%d,%d", method, (int)c[0], (int)c[1], (int)c[2],
                          (int)c[3]));
  PetscCall(TestSolve(test.mesh, "square", options, &solver));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &exact));
  PetscCall(PetscMalloc1(test.mesh->num_local_cells, &a));
  for (PetscInt v = 0; v < test.mesh->num_local; v++) Unroll(test.mesh->position + 3 * v, exact.x + 2 * v);
  PetscCall(EqmAuthalicEnergy(solver->problem->domain, &exact, a, energy, NULL));
  for (PetscInt v = 0; v < test.mesh->num_owned; v++) {
    const PetscReal squared = PetscSqr(exact.x[2 * v] - solver->iterate->place.x[2 * v]) +
                              PetscSqr(exact.x[2 * v + 1] - solver->iterate->place.x[2 * v + 1]);
    sum += squared;
    most = PetscMax(most, squared);
  }
  *rms = PetscSqrtReal(TestSum(PETSC_COMM_WORLD, sum) / test.mesh->num_vertices);
  *largest = PetscSqrtReal(TestMax(PETSC_COMM_WORLD, most));
  CHECK(solver->iterate->totals.folds == 0, "%d folds", (int)solver->iterate->totals.folds);
  PetscCall(PetscFree(a));
  PetscCall(EqmPlaceDestroy(&exact));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The harmonic map with sliding sides needs no iteration: it is the exact map, up to the surface's chords. */
static PetscErrorCode TestConverges(const char *method, PetscReal bound)
{
  PetscReal energy[3], rms[3], largest[3];

  PetscFunctionBegin;
  for (int k = 0; k < 3; k++) {
    PetscCall(Compare(200 << 2 * k, method, &energy[k], &rms[k], &largest[k]));
    PetscCall(PetscPrintf(
        PETSC_COMM_WORLD,
        "%s, about %d vertices: exact map's energy %.3e; the solver's map is %.2e away from it (rms), %.2e at most\n",
        method, 200 << 2 * k, (double)energy[k], (double)rms[k], (double)largest[k]));
    if (k == 0) continue;
    CHECK(energy[k] < energy[k - 1] / 10., "the exact map's energy falls from %g to %g only", (double)energy[k - 1],
          (double)energy[k]);
    CHECK(rms[k] < .35 * rms[k - 1], "%s: the distance falls from %g to %g only", method, (double)rms[k - 1],
          (double)rms[k]);
  }
  CHECK(largest[2] < bound, "%s: %g", method, (double)largest[2]);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestConverges("-method fixed-point -start harmonic -max_it 0", 1e-4));
  PetscCall(TestConverges("-method lm -balance .05 -max_it 40 -energy_rtol 1e-6", 1e-4));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
