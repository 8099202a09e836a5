#include "polygon.h"

#include <math.h>

/* A polygon that is being cut: its corners in the plane, and those that are left, linked in a circle. */
typedef struct {
  PetscInt num_corners;
  PetscReal x[EQM_MAX_POLYGON][2];
  PetscInt next[EQM_MAX_POLYGON], previous[EQM_MAX_POLYGON];
  PetscBool is_left[EQM_MAX_POLYGON], is_ear[EQM_MAX_POLYGON];
} Polygon;

/* Newell's normal: the sum of the cross products of consecutive corners, twice the vector area [Sutherland, Sproull,
   Schumacker, A characterization of ten hidden-surface algorithms, 1974]. */
static void ComputeNormal(PetscInt n, const PetscReal *p, PetscReal normal[3])
{
  normal[0] = normal[1] = normal[2] = 0.0;
  for (PetscInt i = 0; i < n; ++i) {
    const PetscReal *const a = p + 3 * i, *const b = p + 3 * ((i + 1) % n), *const o = p;

    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;

      normal[k] += (a[l] - o[l]) * (b[m] - o[m]) - (a[m] - o[m]) * (b[l] - o[l]);
    }
  }
}

/* Drop the coordinate in which the normal is largest; the polygon then runs counter-clockwise. PETSC_FALSE: it has no
   area, or coordinates that are no numbers. */
static PetscBool Project(PetscInt n, const PetscReal *p, Polygon *polygon)
{
  PetscReal normal[3];
  int largest = 0;

  ComputeNormal(n, p, normal);
  for (int k = 1; k < 3; ++k) {
    if (fabs(normal[k]) > fabs(normal[largest])) largest = k;
  }
  if (!(fabs(normal[largest]) > 0.0) || !isfinite(normal[0] + normal[1] + normal[2])) return PETSC_FALSE;
  const int first = (largest + (normal[largest] > 0.0 ? 1 : 2)) % 3, second = 3 - largest - first;

  polygon->num_corners = n;
  for (PetscInt i = 0; i < n; ++i) {
    polygon->x[i][0] = p[3 * i + first];
    polygon->x[i][1] = p[3 * i + second];
    polygon->next[i] = (i + 1) % n;
    polygon->previous[i] = (i + n - 1) % n;
    polygon->is_left[i] = PETSC_TRUE;
  }
  return PETSC_TRUE;
}

static PetscReal TwiceArea(const PetscReal a[2], const PetscReal b[2], const PetscReal c[2])
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* An ear: a convex corner whose triangle holds no other corner that is left [Meisters, Polygons have ears, 1975]. */
static PetscBool IsEar(const Polygon *polygon, PetscInt i)
{
  const PetscInt before = polygon->previous[i], after = polygon->next[i];
  const PetscReal *const a = polygon->x[before], *const b = polygon->x[i], *const c = polygon->x[after];

  if (!(TwiceArea(a, b, c) > 0.0)) return PETSC_FALSE;
  for (PetscInt j = polygon->next[after]; j != before; j = polygon->next[j]) {
    const PetscReal *const x = polygon->x[j];

    if (TwiceArea(a, b, x) >= 0.0 && TwiceArea(b, c, x) >= 0.0 && TwiceArea(c, a, x) >= 0.0) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The ear whose cut is shortest in space, or, where a polygon that crosses itself has no ear, the corner of the
   shortest cut. Of cuts as long as each other but for rounding the first is taken, beginning with corner 1: a square is
   cut from its corner 0 to its corner 2. */
static PetscInt ChooseCorner(const Polygon *polygon, const PetscReal *p)
{
  PetscInt best = -1;
  PetscReal shortest = 0.0;
  PetscBool best_is_ear = PETSC_FALSE;

  for (PetscInt step = 1; step <= polygon->num_corners; ++step) {
    const PetscInt i = step % polygon->num_corners;
    const PetscReal *const a = p + 3 * polygon->previous[i], *const c = p + 3 * polygon->next[i];
    PetscReal length = 0.0;

    if (!polygon->is_left[i] || (best_is_ear && !polygon->is_ear[i])) continue;
    for (int k = 0; k < 3; ++k) length += (c[k] - a[k]) * (c[k] - a[k]);
    if (best >= 0 && best_is_ear == polygon->is_ear[i] && !(length < (1.0 - 1e-9) * shortest)) continue;
    best = i;
    shortest = length;
    best_is_ear = polygon->is_ear[i];
  }
  return best;
}

static void CutFan(PetscInt n, PetscInt *triangles)
{
  for (PetscInt t = 0; t < n - 2; ++t) {
    triangles[3 * t] = 0;
    triangles[3 * t + 1] = t + 1;
    triangles[3 * t + 2] = t + 2;
  }
}

/* EqmPolygonTriangulate - cut a polygon in space into num_corners - 2 triangles of its orientation, by ears, the
   shortest cut first: a convex quadrilateral is cut along its shorter diagonal. Not collective.

   corners - 3 * num_corners coordinates, 3 <= num_corners <= EQM_MAX_POLYGON
   triangles - 3 * (num_corners - 2) numbers of corners; each triangle begins with its smallest. A polygon without area
   becomes a fan. */
void EqmPolygonTriangulate(PetscInt num_corners, const PetscReal *corners, PetscInt *triangles)
{
  Polygon polygon;

  if (!Project(num_corners, corners, &polygon)) {
    CutFan(num_corners, triangles);
    return;
  }
  for (PetscInt i = 0; i < num_corners; ++i) polygon.is_ear[i] = IsEar(&polygon, i);
  for (PetscInt t = 0; t < num_corners - 2; ++t) {
    const PetscInt i = ChooseCorner(&polygon, corners), before = polygon.previous[i], after = polygon.next[i];
    const PetscInt cut[3] = {before, i, after};
    const int first = before < i && before < after ? 0 : i < after ? 1 : 2;

    for (int k = 0; k < 3; ++k) triangles[3 * t + k] = cut[(first + k) % 3];
    polygon.is_left[i] = PETSC_FALSE;
    polygon.next[before] = after;
    polygon.previous[after] = before;
    polygon.is_ear[before] = IsEar(&polygon, before);
    polygon.is_ear[after] = IsEar(&polygon, after);
  }
}

/* Does a triangle run through an edge the other way? */
static PetscBool HasOpposite(PetscInt num, const PetscInt *triangles, PetscInt tail, PetscInt head)
{
  for (PetscInt k = 0; k < 3 * num; ++k) {
    if (triangles[k] == head && triangles[k - k % 3 + (k + 1) % 3] == tail) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscBool EqmPolygonOfTriangles(PetscInt num, const PetscInt *triangles, PetscInt *cycle)
{
  PetscInt edge[EQM_MAX_POLYGON][2], count = 0, length = 0;

  for (PetscInt k = 0; k < 3 * num; ++k) {
    const PetscInt tail = triangles[k], head = triangles[k - k % 3 + (k + 1) % 3];

    if (HasOpposite(num, triangles, tail, head)) continue;
    if (count == num + 2) return PETSC_FALSE;
    edge[count][0] = tail;
    edge[count++][1] = head;
  }
  if (count != num + 2) return PETSC_FALSE;
  for (PetscInt e = 0; length < count;) {
    PetscInt next = 0;

    cycle[length++] = edge[e][0];
    while (next < count && edge[next][0] != edge[e][1]) ++next;
    if (next == count || (next == 0 && length < count)) return PETSC_FALSE;
    e = next;
  }
  return PETSC_TRUE;
}
