/* Objectives made of terms: gradients against differences, and what methods of descent make of them. */
#include "support/runs.h"
#include "mesh/mesh_private.h"
#include "unfold/unfold.h"
#include <math.h>

/* The slope of the whole objective along a geodesic from the present map, by the gradient and by differences. */
static PetscErrorCode TestSlope(EqmSolver solver, const char *what)
{
  const EqmProblem problem = solver->problem;
  const PetscReal h = 1e-4;
  PetscReal value[4], slope, *image;
  Vec step, gradient;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(problem->domain, &step));
  PetscCall(VecDuplicate(step, &gradient));
  PetscCall(EqmPlaceCreate(problem->domain, &to));
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &image));
  PetscCall(TestRandomStep(problem->domain, 3, .01, step));
  PetscCall(EqmProblemEvaluate(problem, solver->iterate, &solver->iterate->place, image, &value[0], gradient));
  PetscCall(VecDot(gradient, step, &slope));
  for (int k = 0; k < 4; k++) {
    PetscCall(EqmDomainMove(problem->domain, &solver->iterate->place, (k < 2 ? k - 2 : k - 1) * h, step, &to));
    PetscCall(EqmProblemEvaluate(problem, solver->iterate, &to, image, &value[k], NULL));
  }
  const PetscReal difference = (8. * (value[2] - value[1]) - (value[3] - value[0])) / (12. * h);
  CHECK(PetscAbsReal(slope) > 0., "%s: no slope", what);
  CHECK_CLOSE(difference, slope, 1e-6, PetscAbsReal(slope));
  PetscCall(PetscFree(image));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&gradient));
  PetscFunctionReturn(0);
}

/* A map that no method has been at, with the terms that the options ask for. */
static PetscErrorCode Begin(EqmMesh mesh, const char *target, const char *text, PetscBool landmarks, EqmSolver *solver)
{
  static const PetscInt vertex[3] = {5, 40, 77};
  static const PetscReal planar[6] = {.3, .4, -.5, .2, .6, -.1}, spherical[9] = {.6, 0., .8, 0., .6, .8, 0., -1., 0.};
  const PetscInt dim = strcmp(target, "sphere") ? 2 : 3;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(mesh, target, solver));
  PetscCall(EqmSolverSetFromOptions(*solver));
  if (landmarks) PetscCall(EqmSolverSetLandmarks(*solver, 3, dim, vertex, dim == 2 ? planar : spherical, 2., 1e-2));
  PetscCall(EqmSolverSetUp(*solver));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestGradient(EqmMesh mesh, const char *target, const char *options, PetscBool landmarks)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(Begin(mesh, target, options, landmarks, &solver));
  PetscCall(TestSlope(solver, options));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* The term that holds a solid's volume, which unfolding adds. */
static PetscErrorCode TestVolume(void)
{
  struct _p_EqmTerm volume;
  TestMesh ball;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "blob", 300, 3, &ball));
  PetscCall(Begin(ball.mesh, "ball", "-method lbfgs -start harmonic", PETSC_FALSE, &solver));
  EqmTermInitVolume(&volume, 3.);
  PetscCall(EqmProblemAddTerm(solver->problem, &volume));
  PetscCall(TestSlope(solver, "volume"));
  PetscCall(EqmProblemRemoveTerm(solver->problem, &volume));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&ball));
  PetscFunctionReturn(0);
}

/* The angle energy of the map that is found; the area energy beside it. */
static PetscErrorCode AngleError(TestMesh *test, const char *options, PetscReal *error)
{
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(TestMap(test, "disk", options, &map));
  *error = map->distortion.angle_error.mean;
  CHECK(map->distortion.folds == 0, "%s: %d folds", options, (int)map->distortion.folds);
  PetscCall(EqmMapDestroy(&map));
  PetscFunctionReturn(0);
}

/* Both ways to keep angles do: with a weight beside the areas, and the symmetric Dirichlet energy. */
static PetscErrorCode TestAngles(TestMesh *test)
{
  PetscReal plain, balanced, symmetric;

  PetscFunctionBegin;
  PetscCall(AngleError(test, "-method lbfgs -max_it 60", &plain));
  PetscCall(AngleError(test, "-method lbfgs -max_it 60 -balance 1", &balanced));
  PetscCall(AngleError(test, "-objective symmetric-dirichlet -max_it 60", &symmetric));
  CHECK(balanced < .8 * plain, "mean angle error %g, balanced %g", (double)plain, (double)balanced);
  CHECK(symmetric < .8 * plain, "mean angle error %g, symmetric Dirichlet %g", (double)plain, (double)symmetric);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh disk, sphere;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 300, 3, &disk));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 300, 3, &sphere));
  PetscCall(TestGradient(disk.mesh, "disk", "-method lbfgs -start tutte -balance .3", PETSC_FALSE));
  PetscCall(TestGradient(disk.mesh, "disk", "-method ncg -start tutte", PETSC_TRUE));
  PetscCall(TestGradient(disk.mesh, "disk", "-objective symmetric-dirichlet -start tutte", PETSC_TRUE));
  PetscCall(TestGradient(sphere.mesh, "sphere", "-method rgd -start guarded -balance .3", PETSC_TRUE));
  PetscCall(TestVolume());
  PetscCall(TestAngles(&disk));
  PetscCall(TestRefused(disk.mesh, "disk", "-method lm -objective symmetric-dirichlet"));
  PetscCall(TestRefused(sphere.mesh, "sphere", "-objective symmetric-dirichlet"));
  PetscCall(TestRefused(sphere.mesh, "sphere", "-balance .1 -method lm"));
  PetscCall(TestRefused(disk.mesh, "disk", "-objective no-such"));
  PetscCall(TestMeshDestroy(&disk));
  PetscCall(TestMeshDestroy(&sphere));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
