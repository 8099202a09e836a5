#include "builder.h"
#include "polygon.h"

#include <stdio.h>
#include <string.h>

/* EqmBuilderOpen - begin a mesh. Not collective. EqmBuilderFinish must follow. */
void EqmBuilderOpen(EqmBuilder *builder, EqmInput *in)
{
  memset(builder, 0, sizeof(*builder));
  builder->in = in;
}

/* Room for `more` rows beyond `count`; half as much again each time, so that copying stays linear. */
static PetscErrorCode Grow(EqmInput *in, size_t row_bytes, size_t count, size_t more, size_t *capacity, void *array)
{
  size_t wanted = count + more;

  if (wanted > (size_t)PETSC_MAX_INT) {
    return EqmReject(in, EQM_ERR_IO, "the mesh has more than %lld vertices or cells: build with 64-bit indices",
                     (long long)PETSC_MAX_INT);
  }
  wanted = PetscMax(wanted, 1); /* an array, though an empty one */
  if (wanted <= *capacity) return 0;
  if (count) wanted = PetscMax(wanted, count + count / 2);
  EqmTry(PetscRealloc(wanted * row_bytes, (void **)array));
  *capacity = wanted;
  return 0;
}

/* EqmBuilderAddVertices - append `count` vertices; the caller fills `vertices` (3 * count). Not collective. The pointer
   is good until the next call. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddVertices(EqmBuilder *builder, size_t count, PetscReal **vertices)
{
  EqmTry(Grow(builder->in, 3 * sizeof(PetscReal), builder->num_vertices, count, &builder->vertex_capacity,
              &builder->vertices));
  *vertices = builder->vertices + 3 * builder->num_vertices;
  builder->num_vertices += count;
  return 0;
}

/* EqmBuilderAddCells - append `count` triangles (cell_size 3) or tetrahedra (4); the caller fills `cells`. Not
   collective. The pointer is good until the next call. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddCells(EqmBuilder *builder, PetscInt cell_size, size_t count, PetscInt **cells)
{
  EqmCellList *list = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;

  EqmTry(Grow(builder->in, (size_t)cell_size * sizeof(PetscInt), list->count, count, &list->capacity, &list->corners));
  *cells = list->corners + (size_t)cell_size * list->count;
  list->count += count;
  return 0;
}

/* EqmBuilderAddTexturePoints - append `count` points of the texture plane; the caller fills `points` (2 * count). Not
   collective. The pointer is good until the next call. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddTexturePoints(EqmBuilder *builder, size_t count, PetscReal **points)
{
  EqmTry(Grow(builder->in, 2 * sizeof(PetscReal), builder->num_texture_points, count, &builder->texture_capacity,
              &builder->texture_points));
  *points = builder->texture_points + 2 * builder->num_texture_points;
  builder->num_texture_points += count;
  return 0;
}

/* EqmBuilderStartFace - begin a face, whose corners follow. Not collective. */
void EqmBuilderStartFace(EqmBuilder *builder)
{
  builder->num_face_corners = 0;
}

/* EqmBuilderAddCorner - the next corner of the face that was begun: its vertex, counted from 0, and its texture point
   or -1. Not collective. Both are checked later. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddCorner(EqmBuilder *builder, PetscInt64 vertex, PetscInt64 texture)
{
  PetscInt64 *corner;

  EqmTry(
      Grow(builder->in, 2 * sizeof(PetscInt64), builder->num_face_corners, 1, &builder->face_capacity, &builder->face));
  corner = builder->face + 2 * builder->num_face_corners++;
  corner[0] = vertex;
  corner[1] = texture < 0 || texture > PETSC_MAX_INT ? -1 : texture;
  return 0;
}

static PetscErrorCode CheckFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices)
{
  const size_t n = builder->num_face_corners;

  if (n < 3) {
    return EqmRejectAt(builder->in, position, EQM_ERR_IO, "face %zu has %zu corners instead of three",
                       builder->triangles.count, n);
  }
  if (n > EQM_MAX_POLYGON) {
    return EqmRejectAt(builder->in, position, EQM_ERR_MESH,
                       "face %zu has %zu corners; up to %d are cut into triangles: triangulate the mesh first",
                       builder->triangles.count, n, EQM_MAX_POLYGON);
  }
  for (size_t k = 0; k < n; ++k) {
    const PetscInt64 vertex = builder->face[2 * k];

    if (vertex < 0 || vertex >= num_vertices) {
      return EqmRejectAt(builder->in, position, EQM_ERR_IO, "vertex index %lld is out of range 0..%lld",
                         (long long)vertex, (long long)num_vertices - 1);
    }
  }
  return 0;
}

/* Texture points of the corners of triangles that were added without any are -1. */
static PetscErrorCode SetTexture(EqmBuilder *builder, size_t triangle, const PetscInt texture[3])
{
  if (triangle >= builder->num_textured) {
    EqmTry(Grow(builder->in, 3 * sizeof(PetscInt), builder->num_textured, triangle + 1 - builder->num_textured,
                &builder->textured_capacity, &builder->textured));
  }
  while (builder->num_textured <= triangle) {
    PetscInt *const corner = builder->textured + 3 * builder->num_textured++;

    corner[0] = corner[1] = corner[2] = -1;
  }
  for (int k = 0; k < 3; ++k) builder->textured[3 * triangle + (size_t)k] = texture[k];
  return 0;
}

static PetscErrorCode SetTriangle(EqmBuilder *builder, size_t triangle, const PetscInt vertex[3],
                                  const PetscInt texture[3])
{
  for (int k = 0; k < 3; ++k) builder->triangles.corners[3 * triangle + (size_t)k] = vertex[k];
  if (texture[0] >= 0 && texture[1] >= 0 && texture[2] >= 0) EqmTry(SetTexture(builder, triangle, texture));
  return 0;
}

/* Room for the triangles of a polygon, which is cut at the end, when all vertices are known. */
static PetscErrorCode KeepPolygon(EqmBuilder *builder)
{
  const size_t n = builder->num_face_corners;
  EqmCellList *const pool = &builder->polygon_corners;
  PetscInt *unused;

  EqmTry(
      Grow(builder->in, sizeof(EqmPolygon), builder->num_polygons, 1, &builder->polygon_capacity, &builder->polygons));
  EqmTry(Grow(builder->in, 2 * sizeof(PetscInt), pool->count, n, &pool->capacity, &pool->corners));
  builder->polygons[builder->num_polygons++] = (EqmPolygon){builder->triangles.count, pool->count, (PetscInt)n};
  for (size_t k = 0; k < 2 * n; ++k) pool->corners[2 * pool->count + k] = (PetscInt)builder->face[k];
  pool->count += n;
  return EqmBuilderAddCells(builder, 3, n - 2, &unused);
}

/* EqmBuilderEndFace - append the face that was begun to the mesh; one of more than three corners becomes triangles. Not
   collective. position - where the file says it, for messages (NULL: not known); num_vertices - what corners may name.
   Errors (quiet): EQM_ERR_IO for a corner out of range and for fewer than three corners, EQM_ERR_MESH for more than
   EQM_MAX_POLYGON. */
PetscErrorCode EqmBuilderEndFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices)
{
  PetscInt vertex[3], texture[3], *cell;

  EqmTry(CheckFace(builder, position, num_vertices));
  if (builder->num_face_corners > 3) return KeepPolygon(builder);
  EqmTry(EqmBuilderAddCells(builder, 3, 1, &cell));
  for (int k = 0; k < 3; ++k) {
    vertex[k] = (PetscInt)builder->face[2 * k];
    texture[k] = (PetscInt)builder->face[2 * k + 1];
  }
  return SetTriangle(builder, builder->triangles.count - 1, vertex, texture);
}

/* EqmBuilderAddFace - append a face whose corners, counted from 0, are at hand. Not collective. See EqmBuilderEndFace.
 */
PetscErrorCode EqmBuilderAddFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                 PetscInt64 num_corners, const PetscInt64 *corners)
{
  EqmBuilderStartFace(builder);
  for (PetscInt64 k = 0; k < num_corners; ++k) EqmTry(EqmBuilderAddCorner(builder, corners[k], -1));
  return EqmBuilderEndFace(builder, position, num_vertices);
}

/* EqmBuilderAddStrip - append the triangles of strips: each corner makes a triangle with the two before it, every
   second one turned. Not collective. A corner of -1 ends a strip and begins the next. Errors: EQM_ERR_IO (quiet) for a
   corner out of range. */
PetscErrorCode EqmBuilderAddStrip(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                  PetscInt64 num_corners, const PetscInt64 *corners)
{
  PetscInt64 begin = 0;

  for (PetscInt64 k = 0; k < num_corners; ++k) {
    const PetscInt64 turned = (k - begin) % 2;

    if (corners[k] == -1) begin = k + 1;
    if (k - begin < 2) continue;
    const PetscInt64 triangle[3] = {corners[k - 2 + turned], corners[k - 1 - turned], corners[k]};
    /* strips are joined by triangles that repeat a vertex, which are no part of the surface */
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    EqmTry(EqmBuilderAddFace(builder, position, num_vertices, 3, triangle));
  }
  return 0;
}

/* EqmBuilderNoteOther - a cell of two or three dimensions that is neither triangle nor tetrahedron. Not collective.
   Whether it matters shows at the end: a quadrilateral on the boundary of tetrahedra does not. */
void EqmBuilderNoteOther(EqmBuilder *builder, PetscInt dimension, const char *position, const char *what)
{
  char *note = dimension == 2 ? builder->other_surface : builder->other_volume;
  EqmInput in = *builder->in;

  if (note[0]) return;
  in.error = note;
  in.error_length = sizeof(builder->other_surface);
  EqmRejectAt(&in, position, EQM_ERR_MESH, "%s", what);
}

static PetscErrorCode RefuseMesh(const EqmBuilder *builder, const char *format, const char *note)
{
  snprintf(builder->in->error, builder->in->error_length, format, note);
  return EQM_ERR_MESH;
}

/* Tetrahedra if there are any, otherwise triangles. */
static PetscErrorCode ChooseCells(const EqmBuilder *builder, PetscInt *cell_size)
{
  if (builder->other_volume[0]) {
    return RefuseMesh(builder, "%s: only tetrahedra with four vertices can be mapped: convert the mesh",
                      builder->other_volume);
  }
  *cell_size = builder->tetrahedra.count ? 4 : 3;
  if (builder->tetrahedra.count) return 0;
  if (builder->other_surface[0]) {
    return RefuseMesh(builder, "%s: only triangles with three vertices can be mapped: triangulate the mesh first",
                      builder->other_surface);
  }
  if (!builder->triangles.count) {
    return RefuseMesh(builder, "%s", "the mesh has no triangles or tetrahedra: there is nothing to map");
  }
  return 0;
}

static PetscErrorCode CutPolygons(EqmBuilder *builder)
{
  PetscReal x[3 * EQM_MAX_POLYGON];
  PetscInt cut[3 * EQM_MAX_POLYGON];

  for (size_t p = 0; p < builder->num_polygons; ++p) {
    const EqmPolygon *const polygon = &builder->polygons[p];
    const PetscInt *const corners = builder->polygon_corners.corners + 2 * polygon->first_corner;

    for (PetscInt k = 0; k < 3 * polygon->num_corners; ++k)
      x[k] = builder->vertices[3 * (size_t)corners[2 * (k / 3)] + (size_t)(k % 3)];
    EqmPolygonTriangulate(polygon->num_corners, x, cut);
    for (PetscInt t = 0; t < polygon->num_corners - 2; ++t) {
      PetscInt vertex[3], texture[3];

      for (PetscInt k = 0; k < 3; ++k) {
        vertex[k] = corners[2 * cut[3 * t + k]];
        texture[k] = corners[2 * cut[3 * t + k] + 1];
      }
      EqmTry(SetTriangle(builder, polygon->first_triangle + (size_t)t, vertex, texture));
    }
  }
  return 0;
}

/* Texture coordinates of all corners of all triangles; none if one corner has none. */
static PetscErrorCode TakeTexture(const EqmBuilder *builder, EqmSerialMesh *mesh)
{
  const size_t num_corners = 3 * builder->triangles.count;

  if (!builder->num_texture_points || builder->num_textured != builder->triangles.count) return 0;
  for (size_t i = 0; i < num_corners; ++i) {
    if (builder->textured[i] < 0 || (size_t)builder->textured[i] >= builder->num_texture_points) return 0;
  }
  EqmTry(PetscMalloc1(2 * num_corners, &mesh->texture));
  for (size_t i = 0; i < 2 * num_corners; ++i)
    mesh->texture[i] = builder->texture_points[2 * (size_t)builder->textured[i / 2] + i % 2];
  return 0;
}

/* A surface: its polygons are cut, its texture coordinates go with it. */
static PetscErrorCode CompleteSurface(EqmBuilder *builder, EqmSerialMesh *mesh)
{
  EqmTry(CutPolygons(builder));
  if (builder->num_polygons) {
    snprintf(mesh->note, sizeof(mesh->note), "%zu faces of more than three corners were cut into triangles",
             builder->num_polygons);
  }
  return TakeTexture(builder, mesh);
}

static PetscErrorCode FreeLists(EqmBuilder *builder)
{
  EqmTry(PetscFree(builder->vertices));
  EqmTry(PetscFree(builder->triangles.corners));
  EqmTry(PetscFree(builder->tetrahedra.corners));
  EqmTry(PetscFree(builder->polygons));
  EqmTry(PetscFree(builder->polygon_corners.corners));
  EqmTry(PetscFree(builder->textured));
  EqmTry(PetscFree(builder->texture_points));
  return PetscFree(builder->face);
}

/* EqmBuilderFinish - end the mesh: hand it over if `code` is 0 and it has cells, free everything otherwise. Not
   collective. Returns `code`, or EQM_ERR_MESH (quiet) if there are no triangles or tetrahedra, or other cells among
   them. */
PetscErrorCode EqmBuilderFinish(EqmBuilder *builder, PetscErrorCode code, EqmSerialMesh *mesh)
{
  PetscInt cell_size = 0;

  if (!code) code = ChooseCells(builder, &cell_size);
  if (!code && cell_size == 3) code = CompleteSurface(builder, mesh);
  if (!code) {
    EqmCellList *list = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;

    mesh->num_vertices = (PetscInt)builder->num_vertices;
    mesh->num_cells = (PetscInt)list->count;
    mesh->cell_size = cell_size;
    mesh->vertices = builder->vertices;
    mesh->cells = list->corners;
    builder->vertices = NULL;
    list->corners = NULL;
  }
  EqmTry(FreeLists(builder));
  return code;
}
