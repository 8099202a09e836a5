/* Which triangles are drawn: a surface's own, or the boundary of a solid or of a part of it. */
#include "picture/picture.h"
#include <math.h>

static PetscErrorCode AllocateFaces(PetscInt count, EqmFaces *faces)
{
  PetscFunctionBegin;
  faces->num_faces = count;
  PetscCall(PetscMalloc1(3 * count, &faces->vertices));
  PetscCall(PetscMalloc1(count, &faces->cell));
  PetscFunctionReturn(0);
}

/* Side `side` = 4 * cell + k of a tetrahedral mesh: opposite the cell's vertex k, its vertices in outward order. */
static void GetSide(const PetscInt *cells, PetscInt side, PetscInt vertices[3])
{
  static const int outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const PetscInt *cell = &cells[4 * (side / 4)];

  for (int k = 0; k < 3; k++) vertices[k] = cell[outward[side % 4][k]];
}

static PetscInt SmallestVertex(const PetscInt *cells, PetscInt side)
{
  PetscInt v[3];

  GetSide(cells, side, v);
  return PetscMin(v[0], PetscMin(v[1], v[2]));
}

/* Two cells that share a face run through it in opposite directions. */
static PetscBool AreOpposite(const PetscInt *cells, PetscInt a, PetscInt b)
{
  PetscInt v[3], w[3];

  GetSide(cells, a, v);
  GetSide(cells, b, w);
  for (int shift = 0; shift < 3; shift++) {
    if (v[0] == w[shift] && v[1] == w[(shift + 2) % 3] && v[2] == w[(shift + 1) % 3]) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Deal the sides of the kept cells into buckets by their smallest vertex: bucket v is side[start[v]] ..
 * side[start[v+1]-1]. */
static PetscErrorCode BucketSides(const EqmResult *result, const PetscBool *keep, PetscInt *start, PetscInt *side)
{
  const PetscInt n = result->num_vertices;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(start, n + 1));
  for (PetscInt s = 0; s < 4 * result->num_cells; s++) {
    if (keep[s / 4]) start[SmallestVertex(result->cells, s) + 1]++;
  }
  for (PetscInt v = 0; v < n; v++) start[v + 1] += start[v];
  for (PetscInt s = 0; s < 4 * result->num_cells; s++) {
    if (keep[s / 4]) side[start[SmallestVertex(result->cells, s)]++] = s;
  }
  for (PetscInt v = n; v > 0; v--) start[v] = start[v - 1];
  start[0] = 0;
  PetscFunctionReturn(0);
}

/* The sides without a partner are the boundary. */
static PetscErrorCode CollectSingles(const EqmResult *result, const PetscInt *start, const PetscInt *side,
                                     PetscSegBuffer singles)
{
  PetscInt *slot;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < result->num_vertices; v++) {
    for (PetscInt a = start[v]; a < start[v + 1]; a++) {
      PetscBool single = PETSC_TRUE;
      for (PetscInt b = start[v]; b < start[v + 1] && single; b++) {
        single = (PetscBool)!AreOpposite(result->cells, side[a], side[b]);
      }
      if (!single) continue;
      PetscCall(PetscSegBufferGetInts(singles, 1, &slot));
      *slot = side[a];
    }
  }
  PetscFunctionReturn(0);
}

/* The boundary of the kept tetrahedra. */
static PetscErrorCode MakeBoundary(const EqmResult *result, const PetscBool *keep, EqmFaces *faces)
{
  PetscInt *start, *side;
  PetscSegBuffer singles;
  size_t count;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(result->num_vertices + 1, &start, 4 * (size_t)result->num_cells, &side));
  PetscCall(PetscSegBufferCreate(sizeof(PetscInt), 4096, &singles));
  PetscCall(BucketSides(result, keep, start, side));
  PetscCall(CollectSingles(result, start, side, singles));
  PetscCall(PetscFree2(start, side));
  PetscCall(PetscSegBufferGetSize(singles, &count));
  PetscCall(PetscSegBufferExtractAlloc(singles, &side));
  PetscCall(PetscSegBufferDestroy(&singles));
  PetscCall(AllocateFaces((PetscInt)count, faces));
  for (PetscInt f = 0; f < faces->num_faces; f++) {
    GetSide(result->cells, side[f], &faces->vertices[3 * f]);
    faces->cell[f] = side[f] / 4;
  }
  PetscCall(PetscFree(side));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFacesOfSurface(const EqmResult *result, EqmFaces *faces)
{
  PetscBool *keep;

  PetscFunctionBegin;
  if (result->cell_size == 3) {
    PetscCall(AllocateFaces(result->num_cells, faces));
    PetscCall(PetscArraycpy(faces->vertices, result->cells, 3 * result->num_cells));
    for (PetscInt f = 0; f < faces->num_faces; f++) faces->cell[f] = f;
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc1(result->num_cells, &keep));
  for (PetscInt c = 0; c < result->num_cells; c++) keep[c] = PETSC_TRUE;
  PetscCall(MakeBoundary(result, keep, faces));
  PetscCall(PetscFree(keep));
  PetscFunctionReturn(0);
}

/* The middle of the box around all vertices. */
static void Middle(const EqmResult *result, const PetscReal *points, PetscReal middle[3])
{
  for (int d = 0; d < 3; d++) {
    PetscReal low = PETSC_MAX_REAL, high = -PETSC_MAX_REAL;
    for (PetscInt k = 0; k < 4 * result->num_cells; k++) {
      low = PetscMin(low, points[3 * result->cells[k] + d]);
      high = PetscMax(high, points[3 * result->cells[k] + d]);
    }
    middle[d] = .5 * (low + high);
  }
}

PetscErrorCode EqmFacesOfCut(const EqmResult *result, const PetscReal *points, const PetscReal direction[3],
                             EqmFaces *faces)
{
  PetscReal middle[3];
  PetscBool *keep;

  PetscFunctionBegin;
  Middle(result, points, middle);
  PetscCall(PetscMalloc1(result->num_cells, &keep));
  for (PetscInt c = 0; c < result->num_cells; c++) {
    PetscReal height = 0.0;
    for (int k = 0; k < 12; k++)
      height += direction[k % 3] * (points[3 * result->cells[4 * c + k / 3] + k % 3] - middle[k % 3]);
    keep[c] = (PetscBool)(height <= 0.0);
  }
  PetscCall(MakeBoundary(result, keep, faces));
  PetscCall(PetscFree(keep));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFacesReset(EqmFaces *faces)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(faces->vertices));
  PetscCall(PetscFree(faces->cell));
  faces->num_faces = 0;
  PetscFunctionReturn(0);
}

/* A face's normal, as long as twice its area. */
static void FaceNormal(const PetscInt vertices[3], const PetscReal *points, double normal[3])
{
  const PetscReal *a = &points[3 * vertices[0]], *b = &points[3 * vertices[1]], *c = &points[3 * vertices[2]];
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};

  normal[0] = u[1] * v[2] - u[2] * v[1];
  normal[1] = u[2] * v[0] - u[0] * v[2];
  normal[2] = u[0] * v[1] - u[1] * v[0];
}

PetscErrorCode EqmFacesNormals(const EqmFaces *faces, const PetscReal *points, PetscInt num_points, float **normals)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * num_points, normals));
  for (PetscInt f = 0; f < faces->num_faces; f++) {
    double normal[3];
    FaceNormal(&faces->vertices[3 * f], points, normal);
    for (int k = 0; k < 9; k++) (*normals)[3 * faces->vertices[3 * f + k / 3] + k % 3] += (float)normal[k % 3];
  }
  for (PetscInt i = 0; i < num_points; i++) {
    float *n = &(*normals)[3 * i];
    const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int d = 0; d < 3; d++) n[d] = length > 0.0f ? n[d] / length : 0.0f;
  }
  PetscFunctionReturn(0);
}
