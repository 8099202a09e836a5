/* Closest points of triangles and tetrahedra. */
#include "register/closest.h"
#include "geometry/simplex.h"

/* Parameter in [0, 1] of the closest point to y on the segment from a to b. */
static PetscReal AlongSegment(const PetscReal y[3], const PetscReal *a, const PetscReal *b)
{
  const PetscReal ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ay[3] = {y[0] - a[0], y[1] - a[1], y[2] - a[2]};
  const PetscReal squared = EqmDot3(ab, ab);

  return squared > 0. ? PetscMin(1., PetscMax(0., EqmDot3(ab, ay) / squared)) : 0.;
}

static PetscReal SquaredDistance(const PetscReal y[3], PetscInt n, const PetscReal *const corner[],
                                 const PetscReal *barycentric)
{
  PetscReal sum = 0.;

  for (PetscInt k = 0; k < 3; k++) {
    PetscReal difference = -y[k];
    for (PetscInt a = 0; a < n; a++) difference += barycentric[a] * corner[a][k];
    sum += difference * difference;
  }
  return sum;
}

/* The orthogonal projection of y if it lies in the triangle, else the closest point of the three sides. */
PetscReal EqmClosestOnTriangle(const PetscReal y[3], const PetscReal *a, const PetscReal *b, const PetscReal *c,
                               PetscReal barycentric[3])
{
  const PetscReal *const corner[5] = {a, b, c, a, b};
  PetscReal u[3], v[3], n[3], inside[3], squared, best = PETSC_MAX_REAL;

  for (PetscInt k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  EqmCross(u, v, n);
  squared = EqmDot3(n, n);
  for (PetscInt i = 0; i < 3; i++) {
    const PetscReal *const q = corner[i + 1], *const r = corner[i + 2];
    const PetscReal yq[3] = {q[0] - y[0], q[1] - y[1], q[2] - y[2]}, yr[3] = {r[0] - y[0], r[1] - y[1], r[2] - y[2]};
    PetscReal part[3];
    EqmCross(yq, yr, part);
    inside[i] = EqmDot3(part, n) / squared;
  }
  if (inside[0] >= 0. && inside[1] >= 0. && inside[2] >= 0.) {
    const PetscReal sum = inside[0] + inside[1] + inside[2];
    for (PetscInt i = 0; i < 3; i++) barycentric[i] = inside[i] / sum;
    return SquaredDistance(y, 3, corner, barycentric);
  }
  for (PetscInt i = 0; i < 3; i++) { /* also where the triangle is degenerate and the above is not a number */
    const PetscReal t = AlongSegment(y, corner[i], corner[i + 1]);
    PetscReal on_side[3] = {0., 0., 0.}, distance;
    on_side[i] = 1. - t;
    on_side[(i + 1) % 3] = t;
    distance = SquaredDistance(y, 3, corner, on_side);
    if (distance < best) {
      best = distance;
      for (PetscInt k = 0; k < 3; k++) barycentric[k] = on_side[k];
    }
  }
  return best;
}

/* Coordinates by signed areas; a point outside goes to the closest one. */
static PetscReal InPlane(const PetscReal y[3], const PetscReal *const corner[4], PetscReal barycentric[4])
{
  const PetscReal area = EqmArea2(corner[0], corner[1], corner[2]);
  PetscBool inside = PETSC_TRUE;
  PetscReal in_space[3][3];

  for (PetscInt a = 0; a < 3; a++) {
    barycentric[a] = EqmArea2(y, corner[(a + 1) % 3], corner[(a + 2) % 3]) / area;
    inside = (PetscBool)(inside && barycentric[a] >= 0.);
  }
  if (inside) return 0.;
  for (PetscInt a = 0; a < 3; a++) {
    in_space[a][0] = corner[a][0];
    in_space[a][1] = corner[a][1];
    in_space[a][2] = 0.;
  }
  return EqmClosestOnTriangle(y, in_space[0], in_space[1], in_space[2], barycentric);
}

/* Central projection onto the flat triangle: y is a positive combination of its corners, with determinants as
   coordinates. A point outside goes to the closest point of the flat triangle, projected again. */
static PetscReal OnSphere(const PetscReal y[3], const PetscReal *const corner[4], PetscReal barycentric[4])
{
  const PetscReal det = EqmHalfDet(corner[0], corner[1], corner[2]);
  PetscReal sum = 0., place[3] = {0., 0., 0.}, length, squared = 0.;
  PetscBool inside = PETSC_TRUE;

  for (PetscInt a = 0; a < 3; a++) {
    barycentric[a] = EqmHalfDet(y, corner[(a + 1) % 3], corner[(a + 2) % 3]) / det;
    inside = (PetscBool)(inside && barycentric[a] >= 0.);
    sum += barycentric[a];
  }
  if (inside) {
    for (PetscInt a = 0; a < 3; a++) barycentric[a] /= sum;
    return 0.;
  }
  (void)EqmClosestOnTriangle(y, corner[0], corner[1], corner[2], barycentric);
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt k = 0; k < 3; k++) place[k] += barycentric[a] * corner[a][k];
  }
  length = PetscSqrtReal(EqmDot3(place, place));
  for (PetscInt k = 0; k < 3; k++) squared += PetscSqr(place[k] / length - y[k]);
  return squared;
}

/* Coordinates by signed volumes; a point outside goes to the closest one of the faces. */
static PetscReal InTetrahedron(const PetscReal y[3], const PetscReal *const corner[4], PetscReal barycentric[4])
{
  const PetscReal volume = EqmVolume(corner[0], corner[1], corner[2], corner[3]);
  PetscReal best = PETSC_MAX_REAL;
  PetscBool inside = PETSC_TRUE;

  for (PetscInt a = 0; a < 4; a++) {
    const PetscReal *p[4] = {corner[0], corner[1], corner[2], corner[3]};
    p[a] = y;
    barycentric[a] = EqmVolume(p[0], p[1], p[2], p[3]) / volume;
    inside = (PetscBool)(inside && barycentric[a] >= 0.);
  }
  if (inside) return 0.;
  for (PetscInt a = 0; a < 4; a++) {
    PetscReal on_face[3];
    const PetscReal squared =
        EqmClosestOnTriangle(y, corner[(a + 1) % 4], corner[(a + 2) % 4], corner[(a + 3) % 4], on_face);
    if (squared >= best) continue;
    best = squared;
    barycentric[a] = 0.;
    for (PetscInt k = 0; k < 3; k++) barycentric[(a + 1 + k) % 4] = on_face[k];
  }
  return best;
}

PetscReal EqmClosestOnCell(EqmImageKind kind, PetscInt cell_size, const PetscReal y[3],
                           const PetscReal *const corner[4], PetscReal barycentric[4])
{
  if (cell_size == 4) return InTetrahedron(y, corner, barycentric);
  if (kind == EQM_IMAGE_PLANE) return InPlane(y, corner, barycentric);
  if (kind == EQM_IMAGE_SPHERE) return OnSphere(y, corner, barycentric);
  return EqmClosestOnTriangle(y, corner[0], corner[1], corner[2], barycentric);
}

PetscReal EqmSignedMeasure(EqmImageKind kind, PetscInt cell_size, const PetscReal *const corner[4])
{
  if (cell_size == 4) return EqmVolume(corner[0], corner[1], corner[2], corner[3]);
  if (kind == EQM_IMAGE_PLANE) return EqmArea2(corner[0], corner[1], corner[2]);
  return EqmHalfDet(corner[0], corner[1], corner[2]);
}
