/* Point location: points made in known cells are found there, points outside go to the closest place, and all of it is
   the same on any number of ranks; closest points and best rotations against brute force. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "register/closest.h"
#include "geometry/rotation.h"
#include "register/tree.h"
#include <math.h>

enum { POINTS = 200 };

/* An image to search. */
typedef struct {
  TestMesh test;
  EqmSolver solver;
  EqmImageKind kind;
  PetscInt dim;
  const PetscReal *x;
} Image;

static PetscErrorCode Make(const char *shape, const char *target, EqmImageKind kind, Image *image)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(image, sizeof(*image)));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, 600, 3, &image->test));
  image->kind = kind;
  image->dim = kind == EQM_IMAGE_PLANE ? 2 : 3;
  image->x = image->test.mesh->position;
  if (target) {
    PetscCall(TestSolve(image->test.mesh, target, "-method lm -max_it 0", &image->solver));
    image->x = image->solver->iterate->place.x;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Drop(Image *image)
{
  PetscFunctionBegin;
  if (image->solver) PetscCall(EqmSolverDestroy(&image->solver));
  PetscCall(TestMeshDestroy(&image->test));
  PetscFunctionReturn(0);
}

/* The closest cell of all ranks, looked for in all of them. */
static PetscErrorCode BruteForce(const Image *image, const PetscReal *point, PetscReal *distance)
{
  const EqmMesh mesh = image->test.mesh;
  PetscReal best = INFINITY;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    PetscReal place[4][3] = {{0.}}, y[3] = {0., 0., 0.}, barycentric[4];
    const PetscReal *const corner[4] = {place[0], place[1], place[2], place[3]};
    for (PetscInt k = 0; k < image->dim; k++) {
      y[k] = point[k];
      for (PetscInt a = 0; a < mesh->cell_size; a++)
        place[a][k] = image->x[image->dim * mesh->cells[mesh->cell_size * c + a] + k];
    }
    best = PetscMin(best, EqmClosestOnCell(image->kind, mesh->cell_size, y, corner, barycentric));
  }
  *distance = PetscSqrtReal(-TestMax(mesh->comm, -best));
  PetscFunctionReturn(0);
}

/* Points in and around the image, all of them queried by every rank, are found as close as can be, with coordinates
   that lead to the place. */
static PetscErrorCode TestFind(Image *image, PetscReal size, PetscBool outside)
{
  const PetscInt dim = image->dim;
  PetscReal points[3 * POINTS], found[3 * POINTS], clamped = 0.;
  EqmLocator locator;
  EqmLocation location;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < POINTS; p++) {
    PetscReal squared = 0.;
    for (PetscInt k = 0; k < dim; k++) {
      points[dim * p + k] = size * TestRandom(7, p, k);
      squared += PetscSqr(points[dim * p + k]);
    }
    for (PetscInt k = 0; k < dim && image->kind == EQM_IMAGE_SPHERE; k++) points[dim * p + k] /= PetscSqrtReal(squared);
  }
  PetscCall(EqmLocatorCreate(image->test.mesh, image->kind, image->x, &locator));
  PetscCall(EqmLocatorFind(locator, POINTS, points, &location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(EqmLocationInterpolate(location, image->test.mesh, dim, image->x, found));
  for (PetscInt p = 0; p < POINTS; p++) {
    PetscReal squared = 0., length = 1., wanted;
    PetscCall(BruteForce(image, points + dim * p, &wanted));
    if (image->kind == EQM_IMAGE_SPHERE) {
      length = PetscSqrtReal(PetscSqr(found[3 * p]) + PetscSqr(found[3 * p + 1]) + PetscSqr(found[3 * p + 2]));
    }
    for (PetscInt k = 0; k < dim; k++) squared += PetscSqr(found[dim * p + k] / length - points[dim * p + k]);
    CHECK_CLOSE(location->distance[p], wanted, 1e-12, 1.);
    CHECK_CLOSE(PetscSqrtReal(squared), wanted, 1e-12, 1.);
    clamped += wanted > 1e-14;
  }
  CHECK((clamped > 0.) == outside, "%g points of %d outside", (double)clamped, (int)POINTS);
  CHECK(location->num_clamped == (PetscInt64)clamped * image->test.mesh->size, "%g clamped, not %g",
        (double)location->num_clamped, (double)clamped);
  PetscCall(EqmLocationDestroy(&location));
  PetscFunctionReturn(0);
}

/* Every vertex is found in a cell that has it, at itself; ranks with their own questions. */
static PetscErrorCode TestVertices(Image *image)
{
  const EqmMesh mesh = image->test.mesh;
  PetscReal *numbers, *found, *of_cells, *sampled;
  EqmLocator locator;
  EqmLocation location;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_local, &numbers, mesh->num_owned, &found, mesh->num_owned_cells, &of_cells,
                         mesh->num_owned, &sampled));
  for (PetscInt v = 0; v < mesh->num_owned; v++) numbers[v] = mesh->vertex_input[v];
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, numbers));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) of_cells[c] = mesh->cell_input[c];
  PetscCall(EqmLocatorCreate(mesh, image->kind, image->x, &locator));
  PetscCall(EqmLocatorFind(locator, mesh->num_owned, image->x, &location));
  PetscCall(EqmLocatorDestroy(&locator));
  PetscCall(EqmLocationInterpolate(location, mesh, 1, numbers, found));
  PetscCall(EqmLocationSample(location, mesh, 1, of_cells, sampled));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    CHECK(location->distance[v] == 0., "vertex %d lies %g outside", (int)mesh->vertex_input[v],
          (double)location->distance[v]);
    CHECK_CLOSE(found[v], numbers[v], 1e-9, mesh->num_vertices);
    CHECK((PetscInt)sampled[v] == location->cell[v], "cell %d is sampled as %g", (int)location->cell[v],
          (double)sampled[v]);
  }
  PetscCall(EqmLocationDestroy(&location));
  PetscCall(PetscFree4(numbers, found, of_cells, sampled));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestImage(const char *shape, const char *target, EqmImageKind kind, PetscReal size,
                                PetscBool outside)
{
  Image image;

  PetscFunctionBegin;
  PetscCall(Make(shape, target, kind, &image));
  PetscCall(TestFind(&image, size, outside));
  PetscCall(TestVertices(&image));
  PetscCall(Drop(&image));
  PetscFunctionReturn(0);
}

/* The closest point of a triangle beats every point of a fine grid on it. */
static PetscErrorCode TestClosest(void)
{
  enum { GRID = 60 };

  PetscFunctionBegin;
  for (PetscInt trial = 0; trial < 60; trial++) {
    PetscReal p[4][3], barycentric[3], squared, best = INFINITY;
    for (PetscInt k = 0; k < 12; k++) p[k / 3][k % 3] = TestRandom(11, trial, k);
    for (PetscInt k = 0; k < 3 && trial % 5 == 0; k++) p[2][k] = .5 * (p[0][k] + p[1][k]); /* degenerate */
    squared = EqmClosestOnTriangle(p[3], p[0], p[1], p[2], barycentric);
    CHECK_CLOSE(barycentric[0] + barycentric[1] + barycentric[2], 1., 1e-14, 1.);
    for (PetscInt i = 0; i <= GRID; i++) {
      for (PetscInt j = 0; j <= GRID - i; j++) {
        const PetscReal u = (PetscReal)i / GRID, v = (PetscReal)j / GRID;
        PetscReal sum = 0.;
        for (PetscInt k = 0; k < 3; k++) sum += PetscSqr((1. - u - v) * p[0][k] + u * p[1][k] + v * p[2][k] - p[3][k]);
        best = PetscMin(best, sum);
      }
    }
    CHECK(squared <= best + 1e-14 && PetscSqrtReal(squared) >= PetscSqrtReal(best) - 4. / GRID,
          "trial %d: distance %g, on a grid %g", (int)trial, (double)PetscSqrtReal(squared),
          (double)PetscSqrtReal(best));
  }
  PetscFunctionReturn(0);
}

/* Rotated points are rotated back; of reflected ones the result is a rotation none the less. */
static PetscErrorCode TestRotation(PetscInt dim)
{
  PetscFunctionBegin;
  for (PetscInt trial = 0; trial < 20; trial++) {
    PetscReal c[9] = {0.}, given[9], wanted[9], rotation[9], determinant;
    for (PetscInt k = 0; k < 9; k++) given[k] = TestRandom(trial, k, 0);
    PetscCall(EqmBestRotation(dim, given, wanted)); /* some rotation */
    for (PetscInt p = 0; p < 10; p++) {
      PetscReal x[3], y[3];
      for (PetscInt k = 0; k < dim; k++) x[k] = y[k] = TestRandom(trial, p, k);
      EqmRotate(dim, wanted, 1, y);
      for (PetscInt k = 0; k < dim * dim; k++) c[k] += y[k / dim] * x[k % dim];
    }
    PetscCall(EqmBestRotation(dim, c, rotation));
    for (PetscInt k = 0; k < dim * dim; k++) CHECK_CLOSE(rotation[k], wanted[k], 1e-12, 1.);
    for (PetscInt k = 0; k < dim; k++) c[k] *= -1.;
    PetscCall(EqmBestRotation(dim, c, rotation));
    determinant = dim == 2 ? rotation[0] * rotation[3] - rotation[1] * rotation[2]
                           : rotation[0] * (rotation[4] * rotation[8] - rotation[5] * rotation[7]) -
                                 rotation[1] * (rotation[3] * rotation[8] - rotation[5] * rotation[6]) +
                                 rotation[2] * (rotation[3] * rotation[7] - rotation[4] * rotation[6]);
    CHECK_CLOSE(determinant, 1., 1e-13, 1.);
  }
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestClosest());
  PetscCall(TestRotation(2));
  PetscCall(TestRotation(3));
  PetscCall(TestImage("hills", "disk", EQM_IMAGE_PLANE, .6, PETSC_FALSE));
  PetscCall(TestImage("hills", "disk", EQM_IMAGE_PLANE, 1.3, PETSC_TRUE));
  PetscCall(TestImage("head", "sphere", EQM_IMAGE_SPHERE, 1., PETSC_FALSE));
  PetscCall(TestImage("ball", NULL, EQM_IMAGE_SPACE, .5, PETSC_FALSE));
  PetscCall(TestImage("ball", NULL, EQM_IMAGE_SPACE, 1.2, PETSC_TRUE));
  PetscCall(TestImage("head", NULL, EQM_IMAGE_SPACE, 1.5, PETSC_TRUE));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
