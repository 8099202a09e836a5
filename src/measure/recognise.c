#include "measure/recognise.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

/* How far, as a part of the radius or side, vertices may lie from the circle, sphere or square that they are on. */
#define TOLERANCE 1e-3
/* A radius or side so close to one is one: the image is not changed then. */
#define UNIT_TOLERANCE 1e-6

/* The vertices that must lie on the circle or sphere: all of a closed image, else those of the boundary. */
static PetscBool Counts(EqmMesh mesh, PetscBool boundary, PetscInt v)
{
  return boundary ? mesh->on_boundary[v] : PETSC_TRUE;
}

/* Mean of those vertices, as the origin of the sums of a fit. Collective. */
static PetscErrorCode MeanOf(EqmMesh mesh, PetscInt dim, PetscBool boundary, const PetscReal *x, PetscReal mean[3],
                             PetscReal *count)
{
  PetscReal sum[4] = {0.};

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (!Counts(mesh, boundary, v)) continue;
    for (PetscInt k = 0; k < dim; k++) sum[k] += x[dim * v + k];
    sum[3] += 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 4, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) mean[k] = sum[3] > 0. ? sum[k] / sum[3] : 0.;
  *count = sum[3];
  PetscFunctionReturn(0);
}

/* The solution c of A c = b for a symmetric A, by Cramer's rule; PETSC_FALSE if A is singular. */
static PetscBool Solve3(const PetscReal a[3][3], const PetscReal b[3], PetscReal c[3])
{
  const PetscReal det = EqmDet3(a[0], a[1], a[2]);

  c[0] = EqmDet3(b, a[1], a[2]) / det;
  c[1] = EqmDet3(a[0], b, a[2]) / det;
  c[2] = EqmDet3(a[0], a[1], b) / det;
  return (PetscBool)(det != 0. && !PetscIsInfOrNanReal(c[0] + c[1] + c[2]));
}

/* The circle (dim 2) or sphere (3) of least squares through those vertices, linear in c and r^2 - |c|^2: the sum of
   (|x|^2 - 2 c.x - (r^2 - |c|^2))^2 is least [Kasa, A circle fitting procedure and its error analysis, 1976].
   PETSC_FALSE: they do not lie on it. Collective. */
static PetscErrorCode FitSphere(EqmMesh mesh, PetscInt dim, PetscBool boundary, const PetscReal *x, PetscReal center[3],
                                PetscReal *radius, PetscBool *fits)
{
  PetscReal mean[3], count, sum[10] = {0.}, a[3][3] = {{1., 0., 0.}, {0., 1., 0.}, {0., 0., 1.}}, b[3] = {0.}, c[3];
  PetscReal worst = 0.;

  PetscFunctionBegin;
  *fits = PETSC_FALSE;
  PetscCall(MeanOf(mesh, dim, boundary, x, mean, &count));
  if (count < dim + 1) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal y[3] = {0.}, squared;

    if (!Counts(mesh, boundary, v)) continue;
    for (PetscInt k = 0; k < dim; k++) y[k] = x[dim * v + k] - mean[k];
    squared = EqmDot3(y, y);
    for (PetscInt k = 0; k < 3; k++) {
      sum[k] += .5 * squared * y[k];
      sum[3 + k] += y[k] * y[k];
      sum[6 + k] += y[k] * y[(k + 1) % 3];
    }
    sum[9] += squared;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 10, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < dim; k++) {
    b[k] = sum[k];
    a[k][k] = sum[3 + k];
    for (PetscInt l = 0; l < dim; l++) {
      if (l != k) a[k][l] = sum[6 + ((k + 1) % 3 == l ? k : l)];
    }
  }
  if (!Solve3(a, b, c)) PetscFunctionReturn(0);
  *radius = PetscSqrtReal(sum[9] / count + EqmDot3(c, c)); /* the mean of |y|^2 is r^2 - |c|^2 + 2 c.mean(y) */
  for (PetscInt k = 0; k < 3; k++) center[k] = mean[k] + c[k];
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal y[3] = {0.};

    if (!Counts(mesh, boundary, v)) continue;
    for (PetscInt k = 0; k < dim; k++) y[k] = x[dim * v + k] - center[k];
    worst = PetscMax(worst, PetscAbsReal(PetscSqrtReal(EqmDot3(y, y)) - *radius));
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  *fits = (PetscBool)(worst <= TOLERANCE * *radius);
  PetscFunctionReturn(0);
}

/* Do the boundary vertices lie on the sides of the box around the image, and is it a square or cube? Collective. */
static PetscErrorCode FitSquare(EqmMesh mesh, PetscInt dim, const PetscReal *x, PetscReal corner[3], PetscReal *side,
                                PetscBool *fits)
{
  PetscReal box[6], worst = 0., uneven = 0., width[3];

  PetscFunctionBegin;
  *fits = PETSC_FALSE;
  for (PetscInt k = 0; k < 6; k++) box[k] = PETSC_MAX_REAL;
  for (PetscInt k = 0; k < dim * mesh->num_owned; k++) {
    box[k % dim] = PetscMin(box[k % dim], x[k]);
    box[3 + k % dim] = PetscMin(box[3 + k % dim], -x[k]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, mesh->comm));
  for (PetscInt k = 0; k < dim; k++) width[k] = -box[3 + k] - box[k];
  *side = 0.;
  for (PetscInt k = 0; k < dim; k++) *side += width[k] / dim;
  for (PetscInt k = 0; k < dim; k++) uneven = PetscMax(uneven, PetscAbsReal(width[k] - *side));
  if (!(uneven <= .5 * TOLERANCE * *side)) PetscFunctionReturn(0);
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    PetscReal nearest = PETSC_MAX_REAL;

    if (!mesh->on_boundary[v]) continue;
    for (PetscInt k = 0; k < dim; k++)
      nearest = PetscMin(nearest, PetscMin(x[dim * v + k] - box[k], -box[3 + k] - x[dim * v + k]));
    worst = PetscMax(worst, nearest);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &worst, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt k = 0; k < dim; k++) corner[k] = box[k];
  *fits = (PetscBool)(worst <= TOLERANCE * *side && mesh->num_boundary_vertices > 0);
  PetscFunctionReturn(0);
}

/* Area or volume of the image. Collective. */
static PetscErrorCode MeasureImage(EqmMesh mesh, PetscInt dim, const PetscReal *x, PetscReal *measure)
{
  PetscReal sum = 0.;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;

    if (mesh->cell_size == 4)
      sum += PetscAbsReal(EqmVolume(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]));
    else if (dim == 2)
      sum += PetscAbsReal(EqmArea2(x + 2 * v[0], x + 2 * v[1], x + 2 * v[2]));
    else
      sum += EqmArea3(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]);
  }
  PetscCall(MPIU_Allreduce(&sum, measure, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* Too small a difference to the unit domain to be more than rounding. */
static PetscBool IsUnit(const EqmImagePlacement *placement)
{
  PetscReal off = PetscAbsReal(placement->size - 1.);

  for (PetscInt k = 0; k < 3; k++) off = PetscMax(off, PetscAbsReal(placement->center[k]));
  return (PetscBool)(off <= UNIT_TOLERANCE);
}

/* EqmImageRecognise - the domain that an image fills, its centre (of squares and cubes: the corner of least
   coordinates) and its size.

   Collective. x - the images of the mesh's local vertices, dim reals each. Of an image that fills no known domain the
   size is the square root of its area, or the cube root of its volume. An image of the unit domain, up to 1e-6, has
   centre 0 and size 1 exactly. Errors: none of its own. */
PetscErrorCode EqmImageRecognise(EqmMesh mesh, PetscInt dim, const PetscReal *x, EqmImagePlacement *placement)
{
  const PetscBool solid = (PetscBool)(mesh->cell_size == 4), planar = (PetscBool)(!solid && dim == 2);
  PetscReal measure;
  PetscBool fits;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(placement, sizeof(*placement)));
  placement->shape = solid ? EQM_FILLS_BALL : planar ? EQM_FILLS_DISK : EQM_FILLS_SPHERE;
  PetscCall(FitSphere(mesh, dim, (PetscBool)(solid || planar), x, placement->center, &placement->size, &fits));
  if (!fits && (planar || solid)) {
    placement->shape = planar ? EQM_FILLS_SQUARE : EQM_FILLS_CUBE;
    PetscCall(FitSquare(mesh, dim, x, placement->center, &placement->size, &fits));
  }
  if (!fits) {
    PetscCall(MeasureImage(mesh, dim, x, &measure));
    placement->shape = solid ? EQM_FILLS_SOLID : planar ? EQM_FILLS_PLANE : EQM_FILLS_SPACE;
    placement->size = solid ? PetscPowReal(measure, 1. / 3.) : PetscSqrtReal(measure);
    PetscCall(PetscArrayzero(placement->center, 3));
  }
  if (IsUnit(placement)) {
    placement->size = 1.;
    PetscCall(PetscArrayzero(placement->center, 3));
  }
  PetscFunctionReturn(0);
}

/* EqmImageToUnit - move and scale an image to the unit domain. Not collective. x - dim reals per local vertex. */
void EqmImageToUnit(EqmMesh mesh, PetscInt dim, const EqmImagePlacement *placement, PetscReal *x)
{
  const PetscReal *const c = placement->center;

  if (placement->size == 1. && c[0] == 0. && c[1] == 0. && c[2] == 0.) return;
  for (PetscInt i = 0; i < dim * mesh->num_local; i++) x[i] = (x[i] - c[i % dim]) / placement->size;
}

/* EqmDomainShapeName - in words. Not collective. */
const char *EqmDomainShapeName(EqmDomainShape shape)
{
  static const char *const name[] = {
      "disk", "square", "planar, neither disk nor square", "sphere", "a surface in space",
      "ball", "cube",   "a solid, neither ball nor cube"};

  return name[shape];
}

const char *EqmDomainShapeTarget(EqmDomainShape shape)
{
  static const char *const target[] = {
      [EQM_FILLS_DISK] = "disk", [EQM_FILLS_SQUARE] = "square", [EQM_FILLS_SPHERE] = "sphere",
      [EQM_FILLS_BALL] = "ball", [EQM_FILLS_CUBE] = "cube",     [EQM_FILLS_SOLID] = NULL};

  return target[shape];
}
