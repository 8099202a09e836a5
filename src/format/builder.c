#include "builder.h"

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

/* EqmBuilderAddFace - append a polygon of a surface file whose corners count from 0. Not collective. `position` is
   where the file says it. Errors (quiet): EQM_ERR_IO for a corner out of range and for fewer than three corners,
   EQM_ERR_MESH for more than three. */
PetscErrorCode EqmBuilderAddFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                 PetscInt64 num_corners, const PetscInt64 corners[3])
{
  PetscInt *cell;

  if (num_corners < 3) {
    return EqmRejectAt(builder->in, position, EQM_ERR_IO, "face %zu has %lld corners instead of three",
                       builder->triangles.count, (long long)num_corners);
  }
  if (num_corners > 3) {
    return EqmRejectAt(builder->in, position, EQM_ERR_MESH,
                       "face %zu has %lld corners, but only triangles can be mapped: triangulate the mesh first",
                       builder->triangles.count, (long long)num_corners);
  }
  EqmTry(EqmBuilderAddCells(builder, 3, 1, &cell));
  for (PetscInt k = 0; k < 3; ++k) {
    if (corners[k] < 0 || corners[k] >= num_vertices) {
      return EqmRejectAt(builder->in, position, EQM_ERR_IO, "vertex index %lld is out of range 0..%lld",
                         (long long)corners[k], (long long)num_vertices - 1);
    }
    cell[k] = (PetscInt)corners[k];
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

/* EqmBuilderFinish - end the mesh: hand it over if `code` is 0 and it has cells, free everything otherwise. Not
   collective. Returns `code`, or EQM_ERR_MESH (quiet) if there are no triangles or tetrahedra, or other cells among
   them. */
PetscErrorCode EqmBuilderFinish(EqmBuilder *builder, PetscErrorCode code, EqmSerialMesh *mesh)
{
  PetscInt cell_size = 0;

  if (!code) code = ChooseCells(builder, &cell_size);
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
  EqmTry(PetscFree(builder->vertices));
  EqmTry(PetscFree(builder->triangles.corners));
  EqmTry(PetscFree(builder->tetrahedra.corners));
  return code;
}
