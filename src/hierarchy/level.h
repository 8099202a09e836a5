/* What the files of this folder share: stars of vertices, shapes of triangles, one step of decimation. */
#ifndef EQM_LEVEL_H
#define EQM_LEVEL_H

#include "hierarchy/hierarchy.h"
#include "geometry/simplex.h"

/* Triangles around each vertex: corner[start[v]] .. are 3 cell + the corner at which v is. */
typedef struct {
  PetscInt *start, *corner;
} EqmCorners;
PETSC_INTERN PetscErrorCode EqmCornersCreate(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells,
                                             EqmCorners *corners);
PETSC_INTERN PetscErrorCode EqmCornersDestroy(EqmCorners *corners);
/* The same into arrays that are there, num_vertices + 2 and 3 num_cells long. Not collective. */
PETSC_INTERN void EqmCornersFill(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells, EqmCorners *corners);

/* A triangle of a star without its centre: from one vertex of the ring to the next. */
typedef struct {
  PetscInt from, to, cell;
} EqmSpoke;
/* Put the triangles of a star in their order around the centre; of an open star the first begins at the boundary.
   `place`, per vertex of the mesh, is scratch of zeros and is left so. False where the triangles are not one fan. Not
   collective. */
PETSC_INTERN PetscBool EqmOrderSpokes(PetscInt count, EqmSpoke *spoke, EqmSpoke *scratch, PetscInt *place,
                                      PetscBool *closed);

/* Work on a level in pieces that do not touch each other, one thread's each; what lies between pieces comes last, on
   one thread. The pieces are runs of vertices, which are numbered along a curve; their number depends on the level
   alone, so that the same bits come out for any number of threads. */
enum { EQM_VERTICES_OF_PIECE = 8192 };
typedef struct {
  PetscInt count;         /* pieces */
  PetscInt *start, *item; /* of piece k: item[start[k]] .., in ascending order; at `count` what is between them */
} EqmLevelPieces;
/* Sort `num` items, of which `piece` says where each belongs: EQM_BETWEEN_PIECES or the number of a piece. Not
   collective. */
enum { EQM_BETWEEN_PIECES = -1 };
PETSC_INTERN PetscErrorCode EqmLevelPiecesCreate(PetscInt num_vertices, PetscInt num, const int *piece,
                                                 EqmLevelPieces *pieces);
/* The same for `count` pieces of any kind. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelPiecesSort(PetscInt count, PetscInt num, const int *piece, EqmLevelPieces *pieces);
PETSC_INTERN PetscErrorCode EqmLevelPiecesDestroy(EqmLevelPieces *pieces);

/* 4 sqrt(3) area / (sum of squared edges) and twice the area's vector. */
static inline PetscReal EqmTriangleQuality(const PetscReal *p, const PetscReal *q, const PetscReal *r,
                                           PetscReal normal[3])
{
  const PetscReal u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]},
                  w[3] = {r[0] - q[0], r[1] - q[1], r[2] - q[2]};
  const PetscReal squares = EqmDot3(u, u) + EqmDot3(v, v) + EqmDot3(w, w);

  EqmCross(u, v, normal);
  return squares > 0. ? 2. * PetscSqrtReal(3. * EqmDot3(normal, normal)) / squares : 0.;
}

/* Collapse edges of `finer` until its vertices are fewer by options->ratio; `quality`: the least quality of new
   triangles, halved where it is in the way. Fills the records of `finer` and all of `coarser` (but its records). Not
   collective. */
PETSC_INTERN PetscErrorCode EqmDecimate(EqmHierarchyLevel *finer, PetscReal ratio, PetscInt least_boundary,
                                        PetscReal *quality, EqmHierarchyLevel *coarser);
/* How many boundary vertices stay on all levels of a surface of so many cells: a circle cut at b places leaves segments
   of (2 pi / b)^3 / 12, half a triangle is pi / (2 m). Not collective. */
PETSC_INTERN PetscInt EqmHierarchyLeastBoundary(PetscInt num_cells, PetscReal share);
/* Make the coarser levels of level 0, on the first rank. Collective. */
PETSC_INTERN PetscErrorCode EqmHierarchyMakeLevels(EqmHierarchy hierarchy, const EqmHierarchyOptions *options,
                                                   PetscInt least_boundary);
/* Give back what the records have of room beyond their number. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelShrinkRecords(EqmHierarchyLevel *level);
/* Bytes of its arrays. Not collective. */
PETSC_INTERN PetscInt64 EqmLevelMemory(const EqmHierarchyLevel *level);
/* Free its arrays. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelReset(EqmHierarchyLevel *level);

#endif
