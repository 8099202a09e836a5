/* The stars of all vertices of a level, for sweeps. */
#include "hierarchy/relax.h"
#include <stdlib.h>

/* The triangles around a vertex in order; false where they are no fan. */
static PetscBool TakeStar(const EqmHierarchyLevel *level, const EqmCorners *corners, PetscInt v, EqmSpoke *spoke,
                          EqmSpoke *scratch, PetscInt *place, PetscBool *closed)
{
  const PetscInt count = corners->start[v + 1] - corners->start[v];

  for (PetscInt k = 0; k < count; k++) {
    const PetscInt at = corners->corner[corners->start[v] + k], c = at / 3, a = at % 3;
    spoke[k] =
        (EqmSpoke){.from = level->cells[3 * c + (a + 1) % 3], .to = level->cells[3 * c + (a + 2) % 3], .cell = c};
  }
  return EqmOrderSpokes(count, spoke, scratch, place, closed);
}

/* Weights and cotangents of one star, whose triangles are in order. */
static void FillStar(const EqmHierarchyLevel *level, PetscInt v, PetscInt count, PetscBool closed,
                     const EqmSpoke *spoke, PetscInt *ring, PetscReal *weight, PetscReal *cotangent)
{
  const PetscInt size = closed ? count : count + 1;

  for (PetscInt k = 0; k < size; k++) cotangent[k] = weight[k] = 0.;
  for (PetscInt k = 0; k < count; k++) {
    const PetscInt *const corner = level->cells + 3 * spoke[k].cell, next = k + 1 == size ? 0 : k + 1;
    const PetscInt a = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    PetscReal half[3];
    EqmHalfCotangents(level, spoke[k].cell, half);
    ring[k] = spoke[k].from;
    weight[k] = level->weight[spoke[k].cell];
    cotangent[k] += half[(a + 2) % 3];
    cotangent[next] += half[(a + 1) % 3];
  }
  if (!closed) ring[count] = spoke[count - 1].to;
}

/* A vertex is within a piece if its neighbours are. */
static PetscErrorCode MakePieces(const EqmHierarchyLevel *level, EqmLevelStars *stars)
{
  int *piece;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(level->num_vertices, &piece));
  for (PetscInt v = 0; v < level->num_vertices; v++) {
    const PetscInt k = v / EQM_VERTICES_OF_PIECE;
    piece[v] = (int)k;
    for (PetscInt q = stars->start[v]; q < stars->start[v + 1]; q++) {
      if (stars->ring[q] / EQM_VERTICES_OF_PIECE != k) piece[v] = EQM_BETWEEN_PIECES;
    }
  }
  PetscCall(EqmLevelPiecesCreate(level->num_vertices, level->num_vertices, piece, &stars->vertices));
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(0);
}

/* The stars, whose beginnings are known, on the threads; false where one is no fan, or memory is short. */
static PetscBool FillStars(const EqmHierarchyLevel *level, const EqmCorners *corners, PetscInt num,
                           EqmLevelStars *stars)
{
  int bad = 0;

#pragma omp parallel if (num > EQM_VERTICES_OF_PIECE)
  {
    EqmSpoke *const spoke = malloc(2 * (size_t)stars->most * sizeof(*spoke));
    PetscInt *const place = calloc((size_t)level->num_vertices + 1, sizeof(*place));
    int mine = !spoke || !place;
#pragma omp for schedule(static)
    for (PetscInt v = 0; v < num; v++) {
      const PetscInt at = stars->start[v], count = corners->start[v + 1] - corners->start[v];
      PetscBool closed;
      if (mine) continue;
      mine = !TakeStar(level, corners, v, spoke, spoke + stars->most, place, &closed) ||
             stars->start[v + 1] != at + count + !closed;
      if (!mine) FillStar(level, v, count, closed, spoke, stars->ring + at, stars->weight + at, stars->cotangent + at);
    }
    if (mine) {
#pragma omp atomic write
      bad = 1;
    }
    free(spoke);
    free(place);
  }
  return (PetscBool)!bad;
}

PetscErrorCode EqmLevelStarsFill(const EqmHierarchyLevel *level, PetscInt num, EqmLevelStars *stars)
{
  EqmCorners corners;
  PetscInt length = 0;

  PetscFunctionBegin;
  *stars = (EqmLevelStars){.most = 0};
  PetscCall(EqmCornersCreate(level->num_vertices, level->num_cells, level->cells, &corners));
  PetscCall(PetscMalloc1(num + 1, &stars->start));
  for (PetscInt v = 0; v < num; v++) {
    const PetscInt count = corners.start[v + 1] - corners.start[v];
    stars->start[v] = length;
    stars->most = PetscMax(stars->most, count + 1);
    length += count + (level->part[v] != EQM_INSIDE);
  }
  stars->start[num] = length;
  PetscCall(PetscMalloc3(length, &stars->ring, length, &stars->weight, length, &stars->cotangent));
  PetscCheck(FillStars(level, &corners, num, stars), PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "the triangles around a vertex of a level are no fan, or memory is short");
  PetscCall(EqmCornersDestroy(&corners));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelStarsCreate(const EqmHierarchyLevel *level, EqmLevelStars *stars)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelStarsFill(level, level->num_vertices, stars));
  PetscCall(MakePieces(level, stars));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelStarsDestroy(EqmLevelStars *stars)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(stars->start));
  PetscCall(PetscFree3(stars->ring, stars->weight, stars->cotangent));
  PetscCall(EqmLevelPiecesDestroy(&stars->vertices));
  PetscFunctionReturn(0);
}
