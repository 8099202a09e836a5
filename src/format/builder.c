#include "builder.h"

#include <stdio.h>
#include <string.h>

/* EqmBuilderOpen - begin a mesh. Not collective. EqmBuilderFinish must follow. */
void EqmBuilderOpen(EqmBuilder *builder, EqmInput *in)
{
  memset(builder, 0, sizeof(*builder));
  builder->in = in;
}

/* EqmBuilderGrow - room for `more` rows beyond `count`; half as much again each time, so that copying stays linear. Not
   collective. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderGrow(EqmInput *in, size_t row_bytes, size_t count, size_t more, size_t *capacity, void *array)
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
  EqmTry(EqmBuilderGrow(builder->in, 3 * sizeof(PetscReal), builder->num_vertices, count, &builder->vertex_capacity,
                        &builder->vertices));
  *vertices = builder->vertices + 3 * builder->num_vertices;
  builder->num_vertices += count;
  return 0;
}

/* Give the cells that were appended to the list the present row. */
static PetscErrorCode KeepRows(EqmBuilder *builder, EqmCellList *list)
{
  size_t known = list->row_capacity ? list->num_rows : 0;

  EqmTry(EqmBuilderGrow(builder->in, sizeof(PetscInt64), known, list->count - known, &list->row_capacity, &list->row));
  for (; known < list->count; ++known) list->row[known] = builder->row;
  list->num_rows = known;
  return 0;
}

/* EqmBuilderAddCells - append `count` triangles (cell_size 3) or tetrahedra (4); the caller fills `cells`. Not
   collective. The pointer is good until the next call. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddCells(EqmBuilder *builder, PetscInt cell_size, size_t count, PetscInt **cells)
{
  EqmCellList *list = cell_size == 3 ? &builder->triangles : &builder->tetrahedra;

  EqmTry(EqmBuilderGrow(builder->in, (size_t)cell_size * sizeof(PetscInt), list->count, count, &list->capacity,
                        &list->corners));
  *cells = list->corners + (size_t)cell_size * list->count;
  list->count += count;
  return builder->has_rows ? KeepRows(builder, list) : 0;
}

/* EqmBuilderAddTexturePoints - append `count` points of the texture plane; the caller fills `points` (2 * count). Not
   collective. The pointer is good until the next call. Errors: EQM_ERR_IO (quiet) if there are too many. */
PetscErrorCode EqmBuilderAddTexturePoints(EqmBuilder *builder, size_t count, PetscReal **points)
{
  EqmTry(EqmBuilderGrow(builder->in, 2 * sizeof(PetscReal), builder->num_texture_points, count,
                        &builder->texture_capacity, &builder->texture_points));
  *points = builder->texture_points + 2 * builder->num_texture_points;
  builder->num_texture_points += count;
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
