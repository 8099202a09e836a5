/* Sweeps over the vertices of a shared level. */
#include "hierarchy/sharedmap.h"
#include <omp.h>

/* A vertex is at a border if not all of its neighbours are in its piece. */
static void FindBorders(const EqmSharedLevel *shared, const EqmLevelStars *stars, char *border)
{
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    const PetscInt begin = shared->vertex_start[k], end = shared->vertex_start[k + 1];
    for (PetscInt v = begin; v < end; v++) {
      border[v] = 0;
      for (PetscInt q = stars->start[v]; q < stars->start[v + 1]; q++)
        border[v] |= stars->ring[q] < begin || stars->ring[q] >= end;
    }
  }
}

PetscErrorCode EqmSharedStarsCreate(const EqmSharedLevel *shared, EqmSharedStars *stars)
{
  PetscInt *color;
  char *border;
  int *group;

  PetscFunctionBegin;
  PetscCall(EqmLevelStarsFill(&shared->level, shared->num_owned, &stars->stars));
  PetscCall(PetscMalloc3(shared->level.num_vertices, &color, shared->num_owned, &border, shared->num_owned, &group));
  FindBorders(shared, &stars->stars, border);
  PetscCall(EqmSharedColor(shared, &stars->stars, border, color, &stars->num_colors));
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    for (PetscInt v = shared->vertex_start[k]; v < shared->vertex_start[k + 1]; v++)
      group[v] = (int)(border[v] ? shared->num_pieces + color[v] : k);
  }
  PetscCall(EqmLevelPiecesSort(shared->num_pieces + stars->num_colors, shared->num_owned, group, &stars->group));
  PetscCall(PetscFree3(color, border, group));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedStarsDestroy(EqmSharedStars *stars)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelStarsDestroy(&stars->stars));
  PetscCall(EqmLevelPiecesDestroy(&stars->group));
  PetscFunctionReturn(0);
}

/* What is inside the pieces. `ring`: scratch per thread. */
static void RelaxInside(EqmLevelMap *map, const EqmSharedStars *stars, PetscInt num_pieces, PetscBool backwards,
                        PetscReal (*ring)[3])
{
  const PetscInt *const start = stars->group.start;

#pragma omp parallel for schedule(dynamic) if (num_pieces > 1)
  for (PetscInt k = 0; k < num_pieces; k++)
    EqmRelaxVertices(map, &stars->stars, start[k + 1] - start[k], stars->group.item + start[k], backwards,
                     ring + stars->stars.most * omp_get_thread_num());
}

/* The vertices of a colour. */
static void RelaxColor(EqmLevelMap *map, const EqmSharedStars *stars, PetscInt group, PetscReal (*ring)[3])
{
  enum { VERTICES_OF_TASK = 256 };
  const PetscInt *const item = stars->group.item + stars->group.start[group];
  const PetscInt num = stars->group.start[group + 1] - stars->group.start[group];

#pragma omp parallel for schedule(static) if (num > VERTICES_OF_TASK)
  for (PetscInt k = 0; k < num; k += VERTICES_OF_TASK)
    EqmRelaxVertices(map, &stars->stars, PetscMin(num - k, (PetscInt)VERTICES_OF_TASK), item + k, PETSC_FALSE,
                     ring + stars->stars.most * omp_get_thread_num());
}

PetscErrorCode EqmSharedRelax(const EqmSharedLevel *shared, EqmLevelMap *map, const EqmSharedStars *stars,
                              PetscInt sweeps)
{
  PetscReal(*ring)[3];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(stars->stars.most * omp_get_max_threads(), &ring));
  for (PetscInt s = 0; s < sweeps; s++) {
    RelaxInside(map, stars, shared->num_pieces, (PetscBool)(s % 2), ring);
    for (PetscInt c = 0; c < stars->num_colors; c++) {
      RelaxColor(map, stars, shared->num_pieces + c, ring);
      PetscCall(EqmSharedUpdateGhosts(shared, map->dim, map->x));
    }
  }
  PetscCall(PetscFree(ring));
  PetscFunctionReturn(0);
}
