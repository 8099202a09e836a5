/* Conformal maps of closed surfaces with thin limbs, on which other maps jam or fold. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "store/map_private.h"

/* Folds as others count them: determinants as they stand in the textbook. */
static PetscInt PlainFolds(EqmMesh mesh, const PetscReal *x)
{
  PetscReal folds = 0.;

  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscReal *const p = x + 3 * mesh->cells[3 * c], *const q = x + 3 * mesh->cells[3 * c + 1],
                           *const r = x + 3 * mesh->cells[3 * c + 2];
    const PetscReal det =
        (p[1] * q[2] - p[2] * q[1]) * r[0] + (p[2] * q[0] - p[0] * q[2]) * r[1] + (p[0] * q[1] - p[1] * q[0]) * r[2];
    folds += det <= 0.;
  }
  return (PetscInt)TestSum(mesh->comm, folds);
}

typedef struct {
  PetscReal before, after; /* mean angle errors in degrees */
  PetscReal smallest;      /* image */
} Outcome;

/* Map the soup (taken over) by default, with and without a second attempt. */
static PetscErrorCode Run(EqmSoup soup, Outcome *outcome)
{
  TestMesh test;
  EqmSolver solver;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(TestSolve(test.mesh, "conformal", "-intrinsic 0", &solver));
  PetscCall(EqmSolverGetMap(solver, test.soup, &map));
  outcome->before = map->distortion.angle_error.mean;
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestSolve(test.mesh, "conformal", "", &solver));
  PetscCall(EqmSolverGetMap(solver, test.soup, &map));
  outcome->after = map->distortion.angle_error.mean;
  CHECK(map->status == EQM_STATUS_CONVERGED && map->distortion.folds == 0, "%s", map->message);
  CHECK(PlainFolds(test.mesh, solver->iterate->place.x) == 0, "%d folds",
        (int)PlainFolds(test.mesh, solver->iterate->place.x));
  PetscCall(EqmSphereSmallestImage(solver->problem, &solver->iterate->place, &outcome->smallest));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Five arms of stretched triangles: many cotangent weights are negative. */
static PetscErrorCode TestStarfish(void)
{
  Outcome alone, together;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_SELF, "starfish", 1500, 1, &soup));
  PetscCall(Run(soup, &alone));
  CHECK(alone.after < 4. && alone.after < .5 * alone.before, "mean angle errors %g and %g", (double)alone.before,
        (double)alone.after);
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "starfish", 1500, 1, &soup));
  PetscCall(Run(soup, &together));
  CHECK_CLOSE(together.after, alone.after, 1e-2, alone.after);
  PetscFunctionReturn(0);
}

/* A needle, whose conformal map has triangles that no arithmetic of 16 digits resolves. */
static PetscErrorCode TestNeedle(void)
{
  Outcome outcome;
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "sphere", 2500, 1, &soup));
  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) soup->vertices[3 * v + 2] *= 12.;
  PetscCall(Run(soup, &outcome));
  CHECK(outcome.smallest > 1e-16, "a triangle of area %g", (double)outcome.smallest);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestStarfish());
  PetscCall(TestNeedle());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
