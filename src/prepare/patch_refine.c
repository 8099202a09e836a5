/* Refine a patch until its triangles are as large as those around the hole (Liepa 2003 section 4): centres are inserted
   where a triangle is large for the edges near it, edges are flipped that are not Delaunay, inner vertices move to the
   mean of their neighbours. */
#include "prepare/step.h"
#include "geometry/simplex.h"
#include "base/sort.h"

/* Triangles grow towards the middle, so that a loop of n edges takes not n^2 of them. */
#define GROWTH 1.2

enum { MOST_ROUNDS = 20, MOST_PASSES = 12, SMOOTHING_SWEEPS = 30, MOST_TRIANGLES = 4000000 };

/* Half-edges of all triangles, sorted by their ends. */
typedef struct {
  PetscInt low, high, triangle, corner; /* opposite the edge */
} HalfEdge;

static int CompareHalfEdges(const void *a, const void *b)
{
  const HalfEdge *const s = a, *const t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  if (s->high != t->high) return s->high < t->high ? -1 : 1;
  return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

static int CompareEnds(const void *a, const void *b)
{
  const HalfEdge *const s = a, *const t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  return (s->high > t->high) - (s->high < t->high);
}

static PetscErrorCode SortHalfEdges(const EqmPatch *patch, HalfEdge **half)
{
  const PetscInt n = 3 * patch->num_triangles;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, half));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt *const v = patch->triangle + 3 * (k / 3), p = v[(k + 1) % 3], q = v[(k + 2) % 3];
    (*half)[k] = (HalfEdge){PetscMin(p, q), PetscMax(p, q), k / 3, k % 3};
  }
  EqmSort(*half, (size_t)n, sizeof(HalfEdge), CompareHalfEdges);
  PetscFunctionReturn(0);
}

static PetscReal Distance(const PetscReal *x, const PetscReal *y)
{
  return PetscSqrtReal(PetscSqr(x[0] - y[0]) + PetscSqr(x[1] - y[1]) + PetscSqr(x[2] - y[2]));
}

/* Cotangent of the angle at r. */
static PetscReal Cotangent(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  const PetscReal u[3] = {p[0] - r[0], p[1] - r[1], p[2] - r[2]}, v[3] = {q[0] - r[0], q[1] - r[1], q[2] - r[2]};
  PetscReal n[3];

  EqmCross(u, v, n);
  return EqmDot3(u, v) / PetscMax(PetscSqrtReal(EqmDot3(n, n)), PETSC_MACHINE_EPSILON * EqmDot3(u, u));
}

/* Flip the edge between two triangles, if it is not Delaunay and the other diagonal is neither there nor forbidden. At
   most one flip of a pass makes an edge at a vertex: so none is made twice. */
static PetscBool FlipEdge(EqmPatch *patch, const HalfEdge *half, const HalfEdge *first, PetscInt num_forbidden,
                          const PetscInt (*forbidden)[2], PetscBool *used_vertex, PetscBool *used_triangle)
{
  PetscInt *const s = patch->triangle + 3 * first[0].triangle, *const t = patch->triangle + 3 * first[1].triangle;
  const PetscInt a = s[(first[0].corner + 1) % 3], b = s[(first[0].corner + 2) % 3];
  const PetscInt c = s[first[0].corner], d = t[first[1].corner];
  const HalfEdge other = {.low = PetscMin(c, d), .high = PetscMax(c, d)};
  const PetscReal *const x = patch->position;

  if (used_triangle[first[0].triangle] || used_triangle[first[1].triangle] || used_vertex[c] || used_vertex[d] ||
      c == d)
    return PETSC_FALSE;
  if (Cotangent(x + 3 * a, x + 3 * b, x + 3 * c) + Cotangent(x + 3 * a, x + 3 * b, x + 3 * d) >= -1e-9)
    return PETSC_FALSE;
  if (EqmSearch(&other, half, (size_t)(3 * patch->num_triangles), sizeof(HalfEdge), CompareEnds)) return PETSC_FALSE;
  if (PetscMax(c, d) < patch->num_boundary && EqmPatchIsForbidden(c, d, num_forbidden, forbidden)) return PETSC_FALSE;
  used_triangle[first[0].triangle] = used_triangle[first[1].triangle] = PETSC_TRUE;
  used_vertex[c] = used_vertex[d] = PETSC_TRUE;
  s[0] = a;
  s[1] = d;
  s[2] = c;
  t[0] = d;
  t[1] = b;
  t[2] = c;
  return PETSC_TRUE;
}

/* Flip edges in passes until none is left, or long enough. */
static PetscErrorCode Relax(EqmPatch *patch, PetscInt num_forbidden, const PetscInt (*forbidden)[2])
{
  PetscInt flips = 1;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < MOST_PASSES && flips; pass++) {
    PetscBool *used_vertex, *used_triangle;
    HalfEdge *half;

    flips = 0;
    PetscCall(SortHalfEdges(patch, &half));
    PetscCall(PetscCalloc2(patch->num_vertices, &used_vertex, patch->num_triangles, &used_triangle));
    for (PetscInt k = 0; k + 1 < 3 * patch->num_triangles; k++) {
      if (CompareEnds(&half[k], &half[k + 1])) continue;
      flips += FlipEdge(patch, half, &half[k], num_forbidden, forbidden, used_vertex, used_triangle);
    }
    PetscCall(PetscFree2(used_vertex, used_triangle));
    PetscCall(PetscFree(half));
  }
  PetscFunctionReturn(0);
}

/* The length of edges around each vertex of the loop. */
static void ScaleLoop(const EqmPatch *patch, PetscReal *scale)
{
  const PetscInt n = patch->num_boundary;

  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *const x = patch->position;
    scale[k] = .5 * (Distance(x + 3 * k, x + 3 * ((k + 1) % n)) + Distance(x + 3 * k, x + 3 * ((k + n - 1) % n)));
  }
}

/* Is a triangle large enough for a vertex in its centre? */
static PetscBool WantsCenter(const EqmPatch *patch, const PetscInt *v, const PetscReal *scale, PetscReal center[3],
                             PetscReal *mean)
{
  *mean = (scale[v[0]] + scale[v[1]] + scale[v[2]]) / 3.;
  for (int c = 0; c < 3; c++) {
    center[c] = (patch->position[3 * v[0] + c] + patch->position[3 * v[1] + c] + patch->position[3 * v[2] + c]) / 3.;
  }
  for (int a = 0; a < 3; a++) {
    const PetscReal far = PETSC_SQRT2 * Distance(center, patch->position + 3 * v[a]);
    if (far <= *mean || far <= scale[v[a]]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Split the triangles that are large enough at their centres; `created` is how many. */
static PetscErrorCode InsertCenters(EqmPatch *patch, PetscReal **scale, PetscInt *created)
{
  const PetscInt num_before = patch->num_triangles;

  PetscFunctionBegin;
  *created = 0;
  PetscCall(PetscRealloc((size_t)(3 * (patch->num_vertices + num_before)) * sizeof(PetscReal), &patch->position));
  PetscCall(PetscRealloc((size_t)(patch->num_vertices + num_before) * sizeof(PetscReal), scale));
  PetscCall(PetscRealloc((size_t)(9 * num_before) * sizeof(PetscInt), &patch->triangle));
  for (PetscInt t = 0; t < num_before; t++) {
    PetscInt *const v = patch->triangle + 3 * t, *const added = patch->triangle + 3 * patch->num_triangles;
    const PetscInt fresh = patch->num_vertices, a = v[0], b = v[1], c = v[2];
    PetscReal center[3], mean;

    if (!WantsCenter(patch, v, *scale, center, &mean)) continue;
    PetscCall(PetscArraycpy(patch->position + 3 * fresh, center, 3));
    (*scale)[patch->num_vertices++] = GROWTH * mean;
    v[2] = fresh; /* a b fresh */
    added[0] = b;
    added[1] = c;
    added[2] = fresh;
    added[3] = c;
    added[4] = a;
    added[5] = fresh;
    patch->num_triangles += 2;
    ++*created;
  }
  PetscFunctionReturn(0);
}

/* Inner vertices to the mean of their neighbours. */
static PetscErrorCode Smooth(EqmPatch *patch)
{
  const PetscInt n = patch->num_boundary, m = patch->num_vertices;
  PetscReal *sum;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(4 * m, &sum));
  for (PetscInt sweep = 0; sweep < SMOOTHING_SWEEPS; sweep++) {
    PetscCall(PetscArrayzero(sum, 4 * m));
    for (PetscInt k = 0; k < 3 * patch->num_triangles; k++) {
      const PetscInt v = patch->triangle[k], w = patch->triangle[k - k % 3 + (k + 1) % 3];
      for (int c = 0; c < 3; c++) { /* an inner edge is passed once each way */
        sum[4 * v + c] += patch->position[3 * w + c];
      }
      sum[4 * v + 3] += 1.;
    }
    for (PetscInt v = n; v < m; v++) {
      for (int c = 0; c < 3; c++) patch->position[3 * v + c] = sum[4 * v + c] / sum[4 * v + 3];
    }
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* EqmPatchRefine - refine a patch made by EqmPatchCreate, with the same forbidden edges. Not collective. */
PetscErrorCode EqmPatchRefine(PetscInt num_forbidden, const PetscInt (*forbidden)[2], EqmPatch *patch)
{
  PetscInt created = 1;
  PetscReal *scale;

  PetscFunctionBegin;
  if (patch->num_boundary < 4 || !patch->num_triangles) PetscFunctionReturn(0);
  PetscCall(PetscCalloc1(patch->num_vertices, &scale));
  ScaleLoop(patch, scale);
  for (PetscInt v = patch->num_boundary; v < patch->num_vertices; v++) { /* the centre of a fan */
    for (PetscInt k = 0; k < patch->num_boundary; k++) scale[v] += scale[k] / patch->num_boundary;
  }
  PetscCall(Relax(patch, num_forbidden, forbidden));
  for (PetscInt round = 0; round < MOST_ROUNDS && created && patch->num_triangles < MOST_TRIANGLES; round++) {
    PetscCall(InsertCenters(patch, &scale, &created));
    PetscCall(Relax(patch, num_forbidden, forbidden));
  }
  PetscCall(Smooth(patch));
  PetscCall(Relax(patch, num_forbidden, forbidden));
  PetscCall(PetscFree(scale));
  PetscFunctionReturn(0);
}
