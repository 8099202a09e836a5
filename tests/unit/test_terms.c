/* Objectives made of terms: gradients against differences, and what methods of descent make of them. */
#include "support/runs.h"
#include "support/cellform.h"
#include "geometry/simplex.h"
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

static const PetscInt landmark[3] = {5, 40, 77};
static const PetscReal landmark_weight[3] = {1., .4, 3.};

static PetscReal WeightOf(EqmMesh mesh, PetscInt v)
{
  PetscInt k = 0;

  while (mesh->vertex_input[v] != landmark[k]) k++;
  return landmark_weight[k];
}

/* A map that no method has been at, with the terms that the options ask for. */
static PetscErrorCode Begin(EqmMesh mesh, const char *target, const char *text, PetscBool landmarks, EqmSolver *solver)
{
  static const PetscReal planar[6] = {.3, .4, -.5, .2, .6, -.1}, spherical[9] = {.6, 0., .8, 0., .6, .8, 0., -1., 0.};
  const PetscInt dim = strcmp(target, "sphere") ? 2 : 3;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(text, &options));
  PetscCall(EqmSolverCreate(mesh, target, solver));
  PetscCall(EqmSolverSetFromOptions(*solver));
  if (landmarks)
    PetscCall(
        EqmSolverSetLandmarks(*solver, 3, dim, landmark, dim == 2 ? planar : spherical, landmark_weight, 2., 1e-2));
  PetscCall(EqmSolverSetUp(*solver));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* ---- matrices and curves */

/* q of a triangle of the sphere. */
static PetscReal Uprightness(const PetscReal *x, const PetscInt v[3])
{
  const PetscReal *const p = x + 3 * v[0], *const q = x + 3 * v[1], *const r = x + 3 * v[2];

  return PetscLogReal(EqmHalfDet(p, q, r) / EqmArea3(p, q, r));
}

/* Twice the in-plane part of E_D - A of a triangle's displacements, which is quadratic: with the sides of the image
   triangle's plane as axes. */
static PetscReal InPlane(PetscInt dim, const PetscReal *weights, const PetscReal *x, const PetscReal *velocity,
                         const PetscInt v[3])
{
  PetscReal side[2][3] = {{0.}}, axis[2][3] = {{1., 0., 0.}, {0., 1., 0.}}, u[3][2], sum = 0.;

  for (PetscInt k = 0; k < dim; k++) {
    for (PetscInt s = 0; s < 2; s++) side[s][k] = x[dim * v[s + 1] + k] - x[dim * v[0] + k];
  }
  if (dim == 3) { /* Gram and Schmidt: counterclockwise seen from outside */
    const PetscReal length = PetscSqrtReal(EqmDot3(side[0], side[0]));
    for (PetscInt k = 0; k < 3; k++) axis[0][k] = side[0][k] / length;
    const PetscReal along = EqmDot3(side[1], axis[0]);
    for (PetscInt k = 0; k < 3; k++) axis[1][k] = side[1][k] - along * axis[0][k];
    const PetscReal height = PetscSqrtReal(EqmDot3(axis[1], axis[1]));
    for (PetscInt k = 0; k < 3; k++) axis[1][k] /= height;
  }
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt s = 0; s < 2; s++) {
      u[a][s] = 0.;
      for (PetscInt k = 0; k < dim; k++) u[a][s] += velocity[dim * v[a] + k] * axis[s][k];
    }
  }
  for (PetscInt e = 0; e < 3; e++) {
    const PetscReal *const p = u[(e + 1) % 3], *const q = u[(e + 2) % 3];
    sum += weights[e] * (PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]));
  }
  return sum - 2. * EqmArea2(u[0], u[1], u[2]);
}

/* x^T M x of the problem's terms by their definitions: angle and landmarks as they are quadratic, sum w (d q)^2 of the
   upright term by differences along the straight motion. */
static PetscErrorCode DefinedForm(EqmSolver solver, const EqmPlace *place, const PetscReal *velocity, PetscReal *form)
{
  const EqmProblem problem = solver->problem;
  const EqmMesh mesh = problem->mesh;
  const PetscInt dim = problem->domain->dim, n = dim * mesh->num_local;
  PetscReal sum = 0., *weights, *moved;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * mesh->num_local_cells, &weights, n, &moved));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_COTANGENT, NULL, weights));
  for (EqmTerm term = problem->terms; term; term = term->next) {
    for (PetscInt c = 0; c < mesh->num_owned_cells && !strcmp(term->name, "angle"); c++)
      sum += .5 * term->weight * InPlane(dim, weights + 3 * c, place->x, velocity, mesh->cells + 3 * c);
    for (PetscInt i = 0; i < problem->landmarks.num && !strcmp(term->name, "landmarks"); i++) {
      for (PetscInt k = 0; k < dim; k++)
        sum += term->weight * WeightOf(mesh, problem->landmarks.vertex[i]) *
               PetscSqr(velocity[dim * problem->landmarks.vertex[i] + k]);
    }
    for (PetscInt c = 0; c < mesh->num_owned_cells && !strcmp(term->name, "upright"); c++) {
      const PetscReal h = 1e-5;
      const PetscInt *const v = mesh->cells + 3 * c;
      PetscReal q[2];
      for (int side = 0; side < 2; side++) {
        for (PetscInt k = 0; k < 9; k++) {
          const PetscInt at = 3 * v[k / 3] + k % 3;
          moved[at] = place->x[at] + (2 * side - 1) * h * velocity[at];
        }
        q[side] = Uprightness(moved, v);
      }
      sum += term->weight * mesh->weight[c] * PetscSqr((q[1] - q[0]) / (2. * h));
    }
  }
  *form = TestSum(solver->comm, sum);
  PetscCall(PetscFree2(weights, moved));
  PetscFunctionReturn(0);
}

/* The matrices of the terms at the present map against the definition. */
static PetscErrorCode TestMatrix(EqmSolver solver)
{
  const EqmProblem problem = solver->problem;
  const EqmIterate iterate = solver->iterate;
  PetscReal *velocity, form, defined;
  Vec step;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(problem->domain, &step));
  PetscCall(PetscMalloc1(problem->domain->dim * problem->mesh->num_local, &velocity));
  for (PetscInt seed = 0; seed < 2; seed++) {
    PetscCall(TestRandomStep(problem->domain, seed, .01, step));
    PetscCall(EqmDomainExpand(problem->domain, &iterate->place, step, velocity));
    PetscCall(TestTermsForm(problem, &iterate->place, iterate->image, velocity, &form));
    PetscCall(DefinedForm(solver, &iterate->place, velocity, &defined));
    CHECK(form > 0., "no matrix");
    CHECK_CLOSE(form, defined, 1e-6, defined);
  }
  PetscCall(PetscFree(velocity));
  PetscCall(VecDestroy(&step));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestGradient(EqmMesh mesh, const char *target, const char *options, PetscBool landmarks)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(Begin(mesh, target, options, landmarks, &solver));
  PetscCall(TestSlope(solver, options));
  if (solver->problem->terms) PetscCall(TestMatrix(solver));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Along the geodesic of a step with velocity u, J^T W q'' of the upright term, times any v, is sum w q'' dq(v). */
static PetscErrorCode TestUpright(EqmMesh mesh)
{
  const PetscReal h = 1e-3;
  EqmSolver solver;
  EqmTerm term;
  PetscReal *u, *v, *acceleration, product, sum = 0.;
  EqmPlace to;
  Vec step, other, curve;

  PetscFunctionBegin;
  PetscCall(Begin(mesh, "sphere", "-method ncg -start guarded", PETSC_FALSE, &solver));
  const EqmProblem problem = solver->problem;
  const EqmPlace *const place = &solver->iterate->place;
  const PetscInt n = 3 * mesh->num_local;
  PetscCall(EqmTermCreateUpright(problem, .7, &term));
  PetscCall(EqmProblemAddTerm(problem, term));
  PetscCall(TestSlope(solver, "upright"));
  PetscCall(TestMatrix(solver));
  PetscCall(PetscMalloc3(n, &u, n, &v, n, &acceleration));
  PetscCall(EqmPlaceCreate(problem->domain, &to));
  PetscCall(EqmDomainCreateVec(problem->domain, &step));
  PetscCall(VecDuplicate(step, &other));
  PetscCall(VecDuplicate(step, &curve));
  PetscCall(VecZeroEntries(curve));
  PetscCall(TestRandomStep(problem->domain, 5, .01, step));
  PetscCall(TestRandomStep(problem->domain, 6, .01, other));
  PetscCall(EqmDomainExpand(problem->domain, place, step, u));
  PetscCall(EqmDomainExpand(problem->domain, place, other, v));
  PetscCall(EqmDomainCurvature(problem->domain, place, u, acceleration));
  PetscCall(EqmTermsAddCurve(problem, place, solver->iterate->image, u, acceleration, 1., curve));
  PetscCall(VecDot(curve, other, &product));
  PetscReal(*q)[5];
  PetscCall(PetscMalloc1(mesh->num_owned_cells, &q));
  for (int k = 0; k < 5; k++) { /* -h, 0, h along the step; -h, h along the other */
    PetscCall(EqmDomainMove(problem->domain, place, k < 3 ? (k - 1) * h : (2 * k - 7) * h, k < 3 ? step : other, &to));
    for (PetscInt c = 0; c < mesh->num_owned_cells; c++) q[c][k] = Uprightness(to.x, mesh->cells + 3 * c);
  }
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++)
    sum += .7 * mesh->weight[c] * (q[c][2] - 2. * q[c][1] + q[c][0]) / (h * h) * (q[c][4] - q[c][3]) / (2. * h);
  sum = TestSum(solver->comm, sum);
  CHECK(PetscAbsReal(sum) > 0., "no curve");
  CHECK_CLOSE(product, sum, 1e-4, PetscAbsReal(sum));
  PetscCall(PetscFree(q));
  PetscCall(PetscFree3(u, v, acceleration));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&other));
  PetscCall(VecDestroy(&curve));
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

/* One minimum, whatever the method: the least of area and angle energy. */
static PetscErrorCode TestEveryMethod(TestMesh *disk, TestMesh *sphere)
{
  static const char *const methods[] = {"lbfgs", "newton", "ncg", "lm -lm_residual ratio"};
  PetscReal least[2] = {0., 0.};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(methods); k++) {
    for (int target = 0; target < 2; target++) {
      char options[160];
      EqmSolver solver;
      PetscReal value;
      PetscCall(PetscSNPrintf(options, sizeof(options),
                              "-balance .5 -max_it 400 -start guarded -energy_rtol 1e-12 -method %s", methods[k]));
      PetscCall(Begin(target ? sphere->mesh : disk->mesh, target ? "sphere" : "disk", options, PETSC_FALSE, &solver));
      PetscCall(EqmSolverSolve(solver));
      PetscCall(EqmProblemEvaluate(solver->problem, solver->iterate, &solver->iterate->place, solver->iterate->image,
                                   &value, NULL));
      if (k == 0) least[target] = value;
      CHECK_CLOSE(value, least[target], 5e-5, least[target]);
      PetscCall(EqmSolverDestroy(&solver));
    }
  }
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
  PetscCall(TestUpright(sphere.mesh));
  PetscCall(TestAngles(&disk));
  PetscCall(TestEveryMethod(&disk, &sphere));
  PetscCall(TestRefused(disk.mesh, "disk", "-method lm -objective symmetric-dirichlet"));
  PetscCall(TestRefused(sphere.mesh, "sphere", "-objective symmetric-dirichlet"));
  PetscCall(TestRefused(sphere.mesh, "sphere", "-balance .1 -method fixed-point"));
  PetscCall(TestRefused(disk.mesh, "disk", "-method fixed-point -objective symmetric-dirichlet"));
  PetscCall(TestRefused(disk.mesh, "disk", "-method newton -objective conformal"));
  PetscCall(TestRefused(disk.mesh, "disk", "-method lm -lm_residual no-such"));
  PetscCall(TestRefused(disk.mesh, "disk", "-objective no-such"));
  PetscCall(TestMeshDestroy(&disk));
  PetscCall(TestMeshDestroy(&sphere));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
