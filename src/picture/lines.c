/* Lines on a mesh that pictures show on the surface and on its image: curves that the user names, and sharp edges. */
#include "picture/picture.h"
#include "format/table.h"
#include "base/sort.h"
#include <math.h>
#include <stdlib.h>

static PetscErrorCode AddLine(PetscSegBuffer lines, PetscInt a, PetscInt b, PetscInt curve)
{
  PetscInt *slot;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGetInts(lines, 3, &slot));
  slot[0] = a;
  slot[1] = b;
  slot[2] = curve;
  PetscFunctionReturn(0);
}

static PetscBool IsWhole(PetscReal value, PetscReal below)
{
  return (PetscBool)(value >= 0. && value < below && value == PetscFloorReal(value));
}

/* A row per vertex, in the order along the curve: the curve's number, the vertex. */
static PetscErrorCode ReadCurves(const char *file, PetscInt num_vertices, PetscSegBuffer lines)
{
  EqmTable table;

  PetscFunctionBegin;
  PetscCall(EqmTableRead(PETSC_COMM_SELF, file, 2, 2, "a row is the number of a curve and a vertex on it", &table));
  for (PetscInt r = 0; r < table.rows; r++) {
    const PetscReal *const row = table.values + 2 * r;
    if (!IsWhole(row[0], PETSC_MAX_INT) || !IsWhole(row[1], num_vertices))
      EqmFail(PETSC_COMM_SELF, EQM_ERR_USAGE,
              "-lines %s: row %" PetscInt_FMT
              " names curve %.9g and vertex %.9g; curves and vertices count from 0, and the "
              "mesh has %" PetscInt_FMT " vertices",
              file, r + 1, (double)row[0], (double)row[1], num_vertices);
    if (r > 0 && row[-2] == row[0]) PetscCall(AddLine(lines, (PetscInt)row[-1], (PetscInt)row[1], (PetscInt)row[0]));
  }
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}

/* An edge of a face, its vertices in ascending order. */
typedef struct {
  PetscInt a, b, face;
} Edge;

static int CompareEdges(const void *first, const void *second)
{
  const Edge *const p = (const Edge *)first, *const q = (const Edge *)second;

  if (p->a != q->a) return p->a < q->a ? -1 : 1;
  if (p->b != q->b) return p->b < q->b ? -1 : 1;
  return 0;
}

static void UnitNormal(const EqmFaces *faces, PetscInt face, const PetscReal *points, double normal[3])
{
  const PetscInt *const v = faces->vertices + 3 * face;
  const PetscReal *const p = points + 3 * v[0], *const q = points + 3 * v[1], *const r = points + 3 * v[2];
  double length = 0.;

  for (int d = 0; d < 3; d++) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    normal[d] = (q[e] - p[e]) * (r[f] - p[f]) - (q[f] - p[f]) * (r[e] - p[e]);
    length += normal[d] * normal[d];
  }
  for (int d = 0; d < 3; d++) normal[d] = length > 0. ? normal[d] / sqrt(length) : 0.;
}

/* Edges where two faces of the surface, or of the solid's boundary, meet at a larger angle between their normals. */
static PetscErrorCode FindSharp(const EqmResult *result, PetscReal degrees, PetscSegBuffer lines)
{
  const double most = cos(degrees * PETSC_PI / 180.);
  EqmFaces faces;
  Edge *edges;

  PetscFunctionBegin;
  PetscCall(EqmFacesOfSurface(result, &faces));
  PetscCall(PetscMalloc1(3 * faces.num_faces, &edges));
  for (PetscInt k = 0; k < 3 * faces.num_faces; k++) {
    const PetscInt a = faces.vertices[k], b = faces.vertices[k % 3 == 2 ? k - 2 : k + 1];
    edges[k] = (Edge){PetscMin(a, b), PetscMax(a, b), k / 3};
  }
  EqmSort(edges, 3 * (size_t)faces.num_faces, sizeof(Edge), CompareEdges);
  for (PetscInt k = 1; k < 3 * faces.num_faces; k++) {
    double n[3], m[3];
    if (CompareEdges(&edges[k - 1], &edges[k])) continue;
    UnitNormal(&faces, edges[k - 1].face, result->vertices, n);
    UnitNormal(&faces, edges[k].face, result->vertices, m);
    if (n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < most) PetscCall(AddLine(lines, edges[k].a, edges[k].b, -1));
  }
  PetscCall(PetscFree(edges));
  PetscCall(EqmFacesReset(&faces));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmResultFindLines(EqmResult *result, const EqmReportOptions *options)
{
  PetscErrorCode error = 0;
  PetscSegBuffer lines;
  size_t count;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(PetscInt), 1024, &lines));
  if (options->sharp > 0.) error = FindSharp(result, options->sharp, lines);
  if (!error && options->lines[0]) error = ReadCurves(options->lines, result->num_vertices, lines);
  if (!error) {
    PetscCall(PetscSegBufferGetSize(lines, &count));
    PetscCall(PetscSegBufferExtractAlloc(lines, &result->line));
    result->num_lines = (PetscInt)(count / 3);
  }
  PetscCall(PetscSegBufferDestroy(&lines));
  PetscFunctionReturn(error); /* the reader has reported the reason */
}
