/* Triangles and edges while edges are flipped; the algorithm is described in flip.c. */
#ifndef EQM_FLIP_H
#define EQM_FLIP_H

#include "mesh/build.h"

/* Edge and length k are opposite corner k. */
typedef struct {
  PetscInt vertex[3], edge[3];
  PetscReal length[3];
} EqmFlipTriangle;

/* A triangle as one of its edges sees it; also the message to the edge. */
typedef struct {
  PetscInt edge, rank, triangle, corner;
  EqmFlipTriangle shape;
} EqmFlipSide;

typedef struct {
  PetscBool known[2], dirty;
  PetscInt approvals;
  EqmFlipSide side[2]; /* where the edge runs from the lower to the higher vertex, and the other */
} EqmFlipEdge;

typedef struct {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  PetscInt num_triangles, num_edges;
  EqmFlipTriangle *triangle;
  PetscBool *changed;
  PetscInt *claimed; /* per triangle: the edge whose request it approves in this round, or -1 */
  EqmFlipEdge *edge; /* edge number size * k + rank is at k */
  PetscInt64 flips;
} EqmFlipper;

typedef struct {
  PetscInt triangle, corner, edge;
} EqmEdgeId; /* of an edge, for its triangle; as a request of the edge to the triangle */

/* Lengths and edge numbers, before the first round (flip_begin.c). Collective. */
PETSC_INTERN PetscErrorCode EqmFlipperMakeTriangles(EqmSoup soup, EqmFlipper *flipper);
PETSC_INTERN PetscErrorCode EqmFlipperNumberEdges(EqmFlipper *flipper);

#endif
