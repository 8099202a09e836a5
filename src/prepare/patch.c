/* A triangulation of least area of a loop in space (Barequet and Sharir 1995; Liepa 2003 section 3), with a preference
   for round triangles. */
#include "prepare/step.h"
#include "geometry/simplex.h"

/* From longer loops ears are cut first, as the triangulation of least area takes n^3 steps. */
enum { MOST_VERTICES = 500 };

int EqmComparePairs(const void *a, const void *b)
{
  const PetscInt *const s = a, *const t = b;

  if (s[0] != t[0]) return s[0] < t[0] ? -1 : 1;
  return (s[1] > t[1]) - (s[1] < t[1]);
}

/* Are the vertices at two positions of the loop joined by an edge of the mesh? */
PetscBool EqmPatchIsForbidden(PetscInt a, PetscInt b, PetscInt num_forbidden, const PetscInt (*forbidden)[2])
{
  const PetscInt key[2] = {PetscMin(a, b), PetscMax(a, b)};
  PetscInt low = 0, high = num_forbidden;

  while (low < high) {
    const PetscInt middle = (low + high) / 2;
    const PetscInt *const pair = forbidden[middle];

    if (pair[0] == key[0] && pair[1] == key[1]) return PETSC_TRUE;
    if (pair[0] < key[0] || (pair[0] == key[0] && pair[1] < key[1]))
      low = middle + 1;
    else
      high = middle;
  }
  return PETSC_FALSE;
}

static PetscErrorCode AddTriangle(EqmPatch *patch, PetscInt a, PetscInt b, PetscInt c)
{
  PetscInt *const t = patch->triangle + 3 * patch->num_triangles++;

  PetscFunctionBegin;
  t[0] = a;
  t[1] = b;
  t[2] = c;
  PetscFunctionReturn(0);
}

/* Cut off ears, the one with the shortest closing edge first, until few enough vertices are left. */
static PetscErrorCode CutEars(PetscInt num_forbidden, const PetscInt (*forbidden)[2], EqmPatch *patch, PetscInt *n,
                              PetscInt *corner)
{
  PetscFunctionBegin;
  while (*n > MOST_VERTICES) {
    PetscReal best = PETSC_MAX_REAL;
    PetscInt ear = -1;

    for (PetscInt k = 0; k < *n; k++) {
      const PetscInt a = corner[(k + *n - 1) % *n], b = corner[(k + 1) % *n];
      const PetscReal *const x = patch->position + 3 * a, *const y = patch->position + 3 * b;
      const PetscReal squared = PetscSqr(x[0] - y[0]) + PetscSqr(x[1] - y[1]) + PetscSqr(x[2] - y[2]);

      if (squared >= best || EqmPatchIsForbidden(a, b, num_forbidden, forbidden)) continue;
      best = squared;
      ear = k;
    }
    if (ear < 0) break;
    PetscCall(AddTriangle(patch, corner[(ear + *n - 1) % *n], corner[ear], corner[(ear + 1) % *n]));
    --*n;
    for (PetscInt k = ear; k < *n; k++) corner[k] = corner[k + 1];
  }
  PetscFunctionReturn(0);
}

/* The triangles of the part between the places i and j, by the apex of each. */
static PetscErrorCode TakeTriangles(PetscInt n, const PetscInt *corner, const PetscInt *apex, EqmPatch *patch)
{
  PetscInt *stack, depth = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(4 * n, &stack));
  stack[depth++] = 0;
  stack[depth++] = n - 1;
  while (depth) {
    const PetscInt j = stack[--depth], i = stack[--depth], k = apex[n * i + j];

    if (j - i < 2) continue;
    PetscCall(AddTriangle(patch, corner[i], corner[k], corner[j]));
    stack[depth++] = i;
    stack[depth++] = k;
    stack[depth++] = k;
    stack[depth++] = j;
  }
  PetscCall(PetscFree(stack));
  PetscFunctionReturn(0);
}

/* Cost of a triangle: its area, and a smaller term in the edge lengths, which prefers rounder triangles at equal area
   and avoids flat ones. */
static PetscReal Cost(const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  const PetscReal area = EqmArea3(p, q, r);
  PetscReal squares = 0.;

  for (int k = 0; k < 3; k++) squares += PetscSqr(p[k] - q[k]) + PetscSqr(q[k] - r[k]) + PetscSqr(r[k] - p[k]);
  return area + (area > 1e-6 * squares ? .02 : 1e3) * squares;
}

/* Least cost by dynamic programming over the parts of the loop; false where every way uses a forbidden edge. */
static PetscErrorCode LeastCost(PetscInt n, const PetscInt *corner, PetscInt num_forbidden,
                                const PetscInt (*forbidden)[2], EqmPatch *patch, PetscBool *found)
{
  PetscReal *cost;
  PetscInt *apex;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n * n, &cost, n * n, &apex));
  for (PetscInt length = 2; length < n; length++) {
    for (PetscInt i = 0; i + length < n; i++) {
      const PetscInt j = i + length;
      const PetscBool outer = (PetscBool)(length == n - 1);

      cost[n * i + j] = PETSC_MAX_REAL;
      if (!outer && EqmPatchIsForbidden(corner[i], corner[j], num_forbidden, forbidden)) continue;
      for (PetscInt k = i + 1; k < j; k++) {
        const PetscReal parts = cost[n * i + k] + cost[n * k + j];
        PetscReal sum;

        if (!(parts < cost[n * i + j])) continue;
        sum = parts +
              Cost(patch->position + 3 * corner[i], patch->position + 3 * corner[k], patch->position + 3 * corner[j]);
        if (sum >= cost[n * i + j]) continue;
        cost[n * i + j] = sum;
        apex[n * i + j] = k;
      }
    }
  }
  *found = (PetscBool)(cost[n - 1] < PETSC_MAX_REAL);
  if (*found) PetscCall(TakeTriangles(n, corner, apex, patch));
  PetscCall(PetscFree2(cost, apex));
  PetscFunctionReturn(0);
}

/* Triangles from a vertex in the middle. */
static PetscErrorCode FanFromCenter(PetscInt n, const PetscInt *corner, EqmPatch *patch)
{
  const PetscInt center = patch->num_vertices++;

  PetscFunctionBegin;
  for (int c = 0; c < 3; c++) {
    PetscReal sum = 0.;
    for (PetscInt k = 0; k < n; k++) sum += patch->position[3 * corner[k] + c];
    patch->position[3 * center + c] = sum / n;
  }
  for (PetscInt k = 0; k < n; k++) PetscCall(AddTriangle(patch, corner[k], corner[(k + 1) % n], center));
  PetscFunctionReturn(0);
}

/* EqmPatchCreate - fill a loop with triangles of least area between its vertices, none of whose edges is forbidden; or,
   where that cannot be, with a fan around a new vertex in the middle.

   Not collective. loop - positions, 3 * n, counterclockwise around the hole. patch - to be freed with EqmPatchReset. */
PetscErrorCode EqmPatchCreate(PetscInt n, const PetscReal *loop, PetscInt num_forbidden, const PetscInt (*forbidden)[2],
                              EqmPatch *patch)
{
  PetscInt *corner, left = n;
  PetscBool found = PETSC_FALSE;

  PetscFunctionBegin;
  *patch = (EqmPatch){.num_boundary = n, .num_vertices = n};
  PetscCall(PetscMalloc1(3 * (n + 1), &patch->position));
  PetscCall(PetscMalloc1(3 * n, &patch->triangle));
  PetscCall(PetscArraycpy(patch->position, loop, 3 * n));
  PetscCall(PetscMalloc1(n + 1, &corner));
  for (PetscInt k = 0; k < n; k++) corner[k] = k;
  PetscCall(CutEars(num_forbidden, forbidden, patch, &left, corner));
  if (left <= MOST_VERTICES) PetscCall(LeastCost(left, corner, num_forbidden, forbidden, patch, &found));
  if (!found) PetscCall(FanFromCenter(left, corner, patch));
  PetscCall(PetscFree(corner));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPatchReset(EqmPatch *patch)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(patch->position));
  PetscCall(PetscFree(patch->triangle));
  PetscFunctionReturn(0);
}
