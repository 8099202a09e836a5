/* Colours for the vertices at the borders of pieces (Jones and Plassmann 1993): each takes the first that no neighbour
   of higher priority has. Priorities belong to the vertices, so that the colours do not depend on the ranks. */
#include "hierarchy/sharedmap.h"
#include "base/random.h"
#include "base/sort.h"
#include <stdlib.h>

typedef struct {
  PetscReal value;
  PetscInt number, vertex;
} Priority;

static Priority PriorityOf(const EqmSharedLevel *shared, PetscInt vertex)
{
  const PetscInt number = EqmSharedGlobal(shared, vertex);

  return (Priority){.value = EqmHashUniform(1, number, 0), .number = number, .vertex = vertex};
}

/* The higher first. */
static int Compare(const void *left, const void *right)
{
  const Priority *const a = left, *const b = right;

  if (a->value != b->value) return a->value > b->value ? -1 : 1;
  return a->number < b->number ? -1 : a->number > b->number;
}

/* The colour of a vertex, or -1 where a neighbour of higher priority has none yet. */
static PetscInt Choose(const EqmSharedLevel *shared, const EqmLevelStars *stars, const char *border,
                       const Priority *mine, const PetscInt *color)
{
  const PetscInt begin = stars->start[mine->vertex], end = stars->start[mine->vertex + 1];
  PetscInt first = 0;

  for (PetscInt q = begin; q < end; q++) {
    const PetscInt u = stars->ring[q];
    if (color[u] >= 0 || (u < shared->num_owned && !border[u])) continue;
    const Priority other = PriorityOf(shared, u);
    if (Compare(&other, mine) < 0) return -1;
  }
  for (PetscInt q = begin; q < end; q++) {
    if (color[stars->ring[q]] != first) continue;
    first++;
    q = begin - 1;
  }
  return first;
}

PetscErrorCode EqmSharedColor(const EqmSharedLevel *shared, const EqmLevelStars *stars, const char *border,
                              PetscInt *color, PetscInt *num_colors)
{
  PetscInt num = 0, most = 0, left;
  Priority *priority;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < shared->num_owned; v++) num += border[v];
  PetscCall(PetscMalloc1(num, &priority));
  num = 0;
  for (PetscInt v = 0; v < shared->num_owned; v++) {
    if (border[v]) priority[num++] = PriorityOf(shared, v);
  }
  EqmSort(priority, (size_t)num, sizeof(*priority), Compare);
  for (PetscInt v = 0; v < shared->level.num_vertices; v++) color[v] = -1;
  do {
    PetscInt kept = 0;
    for (PetscInt k = 0; k < num; k++) {
      const PetscInt c = Choose(shared, stars, border, &priority[k], color);
      color[priority[k].vertex] = c;
      most = PetscMax(most, c + 1);
      if (c < 0) priority[kept++] = priority[k];
    }
    num = kept;
    PetscCall(PetscSFBcastBegin(shared->halo, MPIU_INT, color, color + shared->num_owned, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(shared->halo, MPIU_INT, color, color + shared->num_owned, MPI_REPLACE));
    PetscCall(MPIU_Allreduce(&num, &left, 1, MPIU_INT, MPI_SUM, shared->comm));
  } while (left > 0);
  PetscCall(PetscFree(priority));
  PetscCall(MPIU_Allreduce(&most, num_colors, 1, MPIU_INT, MPI_MAX, shared->comm));
  PetscFunctionReturn(0);
}
