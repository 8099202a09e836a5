/* Solids to the ball: every method, alone and together, turned inputs, the mending of folds. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "unfold/unfold.h"

/* The default reaches a map without folds; Newton's method a minimum that the others do not go below. */
static PetscErrorCode TestMethods(void)
{
  static const PetscReal most[] = {1.5, 2., 0.}; /* times the minimum, which the last cannot come near */
  static const char *const options[] = {"-max_it 60", "-method ncg -max_it 60", "-method fixed-point -max_it 30"};
  TestMesh test;
  EqmSolver solver;
  PetscReal minimum;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "blob", 700, 2, &test));
  PetscCall(TestSolve(test.mesh, "ball", "-method newton", &solver));
  CHECK(solver->status == EQM_STATUS_CONVERGED, "newton: %s", solver->message);
  CHECK(solver->iterate->totals.folds == 0, "newton: %d folds", (int)solver->iterate->totals.folds);
  CHECK(solver->iterate->gradient_norm < 1e-6, "newton: gradient %g", (double)solver->iterate->gradient_norm);
  minimum = solver->iterate->totals.energy;
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestSolve(test.mesh, "ball", "-method newton -anisotropic_scaling 0", &solver));
  CHECK_CLOSE(solver->iterate->totals.energy, minimum, 1e-6, minimum); /* one minimum, whatever the start */
  PetscCall(EqmSolverDestroy(&solver));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(options); k++) {
    PetscCall(TestSolve(test.mesh, "ball", options[k], &solver));
    CHECK(solver->iterate->totals.folds == 0, "%s: %d folds", options[k], (int)solver->iterate->totals.folds);
    CHECK(solver->iterate->totals.energy > (1. - 1e-9) * minimum, "%s: energy %g below the minimum %g", options[k],
          (double)solver->iterate->totals.energy, (double)minimum);
    CHECK(solver->iterate->totals.energy < (most[k] > 0. ? most[k] * minimum : solver->history[0].energy),
          "%s: energy %g", options[k], (double)solver->iterate->totals.energy);
    PetscCall(EqmSolverDestroy(&solver));
  }
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Turn a mesh round an axis that is no coordinate axis. */
static void Turn(EqmSoup soup)
{
  const PetscReal c = PetscCosReal(.7), s = PetscSinReal(.7);

  for (PetscInt v = 0; v < soup->vertex_end - soup->vertex_start; v++) {
    PetscReal *const p = soup->vertices + 3 * v;
    const PetscReal x = c * p[0] - s * p[1], y = s * p[0] + c * p[1], z = p[2];
    p[0] = x;
    p[1] = c * y - s * z;
    p[2] = s * y + c * z;
  }
}

/* The first iterates' energies do not depend on how the solid lies in space. */
static PetscErrorCode TestTurnedInput(void)
{
  PetscReal energy[11];

  PetscFunctionBegin;
  for (int turned = 0; turned < 2; turned++) {
    EqmSoup soup;
    TestMesh test;
    EqmSolver solver;
    PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "blob", 500, 4, &soup));
    if (turned) Turn(soup);
    PetscCall(TestMeshFromSoup(soup, &test));
    PetscCall(TestSolve(test.mesh, "ball", "-max_it 10 -energy_rtol 0", &solver));
    for (PetscInt k = 0; k <= 10; k++) {
      if (turned) CHECK_CLOSE(solver->history[k].energy, energy[k], 1e-9, energy[k]);
      energy[k] = solver->history[k].energy;
    }
    PetscCall(EqmSolverDestroy(&solver));
    PetscCall(TestMeshDestroy(&test));
  }
  PetscFunctionReturn(0);
}

/* The same energy on one rank and on all, to what block factors of other blocks leave of a converged run. */
static PetscErrorCode TestRanks(void)
{
  TestMesh alone, together;
  EqmSolver one, all;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_SELF, "blob", 600, 1, &alone));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "blob", 600, 1, &together));
  PetscCall(TestSolve(alone.mesh, "ball", "-energy_rtol 1e-8", &one));
  PetscCall(TestSolve(together.mesh, "ball", "-energy_rtol 1e-8", &all));
  CHECK_CLOSE(all->iterate->totals.energy, one->iterate->totals.energy, 1e-4, one->iterate->totals.energy);
  PetscCall(EqmSolverDestroy(&one));
  PetscCall(EqmSolverDestroy(&all));
  PetscCall(TestMeshDestroy(&alone));
  PetscCall(TestMeshDestroy(&together));
  PetscFunctionReturn(0);
}

/* A vertex pulled through its neighbours' faces folds cells; unfolding puts it back. */
static PetscErrorCode TestUnfolding(void)
{
  TestMesh test;
  EqmSolver solver;
  PetscInt64 before, after;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "ball", 500, 1, &test));
  PetscCall(TestSolve(test.mesh, "ball", "-max_it 20", &solver));
  for (PetscInt v = 0; v < test.mesh->num_owned; v++) {
    if (test.mesh->vertex_input[v] % 40 || test.mesh->on_boundary[v]) continue;
    for (PetscInt k = 0; k < 3; k++) solver->iterate->place.x[3 * v + k] += .2;
  }
  PetscCall(EqmMeshUpdateGhosts(test.mesh, 3, solver->iterate->place.x));
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  CHECK(solver->iterate->totals.folds > 0, "nothing is folded");
  PetscCall(EqmBallUnfold(solver->problem, solver->iterate, &before, &after));
  CHECK(before > 0 && after == 0, "%d folds, %d afterwards", (int)before, (int)after);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestMethods());
  PetscCall(TestTurnedInput());
  PetscCall(TestRanks());
  PetscCall(TestUnfolding());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
