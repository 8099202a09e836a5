#include "seam.h"
#include "input.h"

/* The vertex of the cut surface for a corner: one that the vertex has already at this point, or a new one. `next`
   chains the vertices of the cut surface that are one vertex of the surface, -1 at the end; `used`: the first has a
   point. */
static PetscInt FindCopy(EqmSeams *seams, PetscInt vertex, const PetscReal uv[2], PetscBool *used, PetscInt *next)
{
  PetscInt copy = vertex, last = vertex;

  if (!used[vertex]) {
    used[vertex] = PETSC_TRUE;
  } else {
    for (; copy >= 0; last = copy, copy = next[copy]) {
      if (seams->point[2 * (size_t)copy] == uv[0] && seams->point[2 * (size_t)copy + 1] == uv[1]) return copy;
    }
    copy = next[last] = seams->num++;
  }
  next[copy] = -1;
  seams->original[copy] = vertex;
  seams->point[2 * (size_t)copy] = uv[0];
  seams->point[2 * (size_t)copy + 1] = uv[1];
  return copy;
}

/* EqmSeamsFind - cut a surface along the seams of its texture.

   Not collective. texture - 2 * 3 * num_cells, of each corner of each triangle. Vertices keep their numbers with the
   first texture point that a triangle gives them; those of other points follow. Errors: PETSC_ERR_MEM. */
PetscErrorCode EqmSeamsFind(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells, const PetscReal *texture,
                            EqmSeams *seams)
{
  const size_t num_corners = 3 * (size_t)num_cells, most = (size_t)num_vertices + num_corners;
  PetscBool *used;
  PetscInt *next;

  if (most > (size_t)PETSC_MAX_INT) return PETSC_ERR_MEM;
  *seams = (EqmSeams){.num = num_vertices};
  EqmTry(PetscCalloc1(2 * most + 1, &seams->point));
  EqmTry(PetscMalloc1(most + 1, &seams->original));
  EqmTry(PetscMalloc1(num_corners + 1, &seams->corner));
  EqmTry(PetscCalloc1((size_t)num_vertices + 1, &used));
  EqmTry(PetscMalloc1(most + 1, &next));
  for (PetscInt v = 0; v < num_vertices; ++v) seams->original[v] = v;
  for (size_t i = 0; i < num_corners; ++i) seams->corner[i] = FindCopy(seams, cells[i], texture + 2 * i, used, next);
  EqmTry(PetscFree(used));
  return PetscFree(next);
}

/* EqmSeamsReset - free everything. Not collective. */
PetscErrorCode EqmSeamsReset(EqmSeams *seams)
{
  EqmTry(PetscFree(seams->corner));
  EqmTry(PetscFree(seams->original));
  EqmTry(PetscFree(seams->point));
  *seams = (EqmSeams){0};
  return 0;
}
