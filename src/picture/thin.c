/* Fewer faces: vertices that are close are joined. */
#include "picture/thin.h"
#include <petsc/private/hashmapi.h>

enum { FINEST = 600, COARSEST = 8 };

/* The cube around all vertices that faces use. */
static void FindBox(const EqmFaces *faces, const PetscReal *points, PetscReal low[3], PetscReal *side)
{
  PetscReal high[3];

  *side = 0.;
  for (int d = 0; d < 3; d++) {
    low[d] = PETSC_MAX_REAL;
    high[d] = -PETSC_MAX_REAL;
    for (PetscInt k = 0; k < 3 * faces->num_faces; k++) {
      low[d] = PetscMin(low[d], points[3 * faces->vertices[k] + d]);
      high[d] = PetscMax(high[d], points[3 * faces->vertices[k] + d]);
    }
    *side = PetscMax(*side, high[d] - low[d]);
  }
}

/* Per vertex the first vertex in its box of a grid of boxes. */
static PetscErrorCode JoinVertices(const EqmFaces *faces, const PetscReal *points, PetscInt grid, PetscInt *joined)
{
  PetscReal low[3], side;
  PetscHMapI first;

  PetscFunctionBegin;
  FindBox(faces, points, low, &side);
  PetscCall(PetscHMapICreate(&first));
  for (PetscInt k = 0; k < 3 * faces->num_faces; k++) {
    const PetscInt v = faces->vertices[k];
    PetscInt key = 0;
    for (int d = 0; d < 3; d++) {
      const PetscReal place = side > 0. ? (points[3 * v + d] - low[d]) / side * grid : 0.;
      key = grid * key + PetscClipInterval((PetscInt)place, 0, grid - 1);
    }
    PetscCall(PetscHMapIGet(first, key, &joined[v])); /* -1: none so far */
    if (joined[v] >= 0) continue;
    joined[v] = v;
    PetscCall(PetscHMapISet(first, key, v));
  }
  PetscCall(PetscHMapIDestroy(&first));
  PetscFunctionReturn(0);
}

/* The faces that keep three corners, into `thinned` unless it is too small; returns their number. */
static PetscInt KeepFaces(const EqmFaces *faces, const PetscInt *joined, EqmFaces *thinned)
{
  PetscInt kept = 0;

  for (PetscInt f = 0; f < faces->num_faces; f++) {
    const PetscInt *const v = faces->vertices + 3 * f;
    const PetscInt corner[3] = {joined[v[0]], joined[v[1]], joined[v[2]]};
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    if (thinned) {
      for (int k = 0; k < 3; k++) thinned->vertices[3 * kept + k] = corner[k];
      thinned->cell[kept] = faces->cell[f];
    }
    kept++;
  }
  return kept;
}

PetscErrorCode EqmThinFaces(const EqmFaces *faces, const PetscReal *points, PetscInt num_points, PetscInt most,
                            EqmFaces *thinned)
{
  PetscInt *joined, kept = faces->num_faces;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_points, &joined));
  for (PetscInt v = 0; v < num_points; v++) joined[v] = v;
  for (PetscInt grid = FINEST; kept > most && grid >= COARSEST; grid = 3 * grid / 4) {
    PetscCall(JoinVertices(faces, points, grid, joined));
    kept = KeepFaces(faces, joined, NULL);
  }
  PetscCall(PetscMalloc1(3 * kept, &thinned->vertices));
  PetscCall(PetscMalloc1(kept, &thinned->cell));
  thinned->num_faces = KeepFaces(faces, joined, thinned);
  PetscCall(PetscFree(joined));
  PetscFunctionReturn(0);
}
