/* Faces of a mesh that is being made: triangles, polygons, strips, with their texture points. */
#include "builder.h"
#include "polygon.h"

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

  EqmTry(EqmBuilderGrow(builder->in, 2 * sizeof(PetscInt64), builder->num_face_corners, 1, &builder->face_capacity,
                        &builder->face));
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
    EqmTry(EqmBuilderGrow(builder->in, 3 * sizeof(PetscInt), builder->num_textured,
                          triangle + 1 - builder->num_textured, &builder->textured_capacity, &builder->textured));
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

  EqmTry(EqmBuilderGrow(builder->in, sizeof(EqmPolygon), builder->num_polygons, 1, &builder->polygon_capacity,
                        &builder->polygons));
  EqmTry(EqmBuilderGrow(builder->in, 2 * sizeof(PetscInt), pool->count, n, &pool->capacity, &pool->corners));
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

/* EqmBuilderCutPolygons - fill in the triangles of polygons, now that all vertices are known. Not collective.
   coordinates - of the corners of all polygons; NULL: they are those of this builder's vertices. */
PetscErrorCode EqmBuilderCutPolygons(EqmBuilder *builder, const PetscReal *coordinates)
{
  PetscReal x[3 * EQM_MAX_POLYGON];
  PetscInt cut[3 * EQM_MAX_POLYGON];

  for (size_t p = 0; p < builder->num_polygons; ++p) {
    const EqmPolygon *const polygon = &builder->polygons[p];
    const PetscInt *const corners = builder->polygon_corners.corners + 2 * polygon->first_corner;

    for (PetscInt k = 0; k < 3 * polygon->num_corners && !coordinates; ++k)
      x[k] = builder->vertices[3 * (size_t)corners[2 * (k / 3)] + (size_t)(k % 3)];
    EqmPolygonTriangulate(polygon->num_corners, coordinates ? coordinates + 3 * polygon->first_corner : x, cut);
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
