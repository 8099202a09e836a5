/* One simplex: the edges of a cell and their order, and which measures an image cell can have. */
#ifndef EQUIMAP_SIMPLEX_H
#define EQUIMAP_SIMPLEX_H

#include <petscsys.h>

/* What is measured of an image simplex. */
typedef enum {
  EQM_MEASURE_AREA2,       /* signed area in the plane */
  EQM_MEASURE_AREA3,       /* area of a flat triangle in space */
  EQM_MEASURE_HALF_DET,    /* half of det(p, q, r): the sign of a triangle on the sphere, and nearly its area */
  EQM_MEASURE_SOLID_ANGLE, /* of a triangle with corners on the unit sphere, seen from its centre: its area there */
  EQM_MEASURE_VOLUME       /* signed volume of a tetrahedron */
} EqmMeasureKind;

/* Most edges that a cell has: a tetrahedron's. */
#define EQM_MAX_CELL_EDGES 6

/* EqmCellNumEdges - how many edges a cell of `cell_size` vertices has: 3 (triangle) or 6 (tetrahedron). Not collective.
 */
static inline PetscInt EqmCellNumEdges(PetscInt cell_size)
{
  return cell_size == 4 ? EQM_MAX_CELL_EDGES : 3;
}

/* EqmCellEdge - the corners `from` and `to` that edge `e` of a cell joins. Edge e of a triangle is opposite its corner
   e; the edges of a tetrahedron join its corners 01, 02, 03, 12, 13, 23. Not collective. */
static inline void EqmCellEdge(PetscInt cell_size, PetscInt e, PetscInt *from, PetscInt *to)
{
  static const unsigned char ends[2][6][2] = {{{1, 2}, {2, 0}, {0, 1}},
                                              {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  *from = ends[cell_size == 4][e][0];
  *to = ends[cell_size == 4][e][1];
}

/* EqmCellEdgeBetween - the number of the edge between the corners a < b, in the order of EqmCellEdge. Not collective.
 */
static inline PetscInt EqmCellEdgeBetween(PetscInt cell_size, PetscInt a, PetscInt b)
{
  return cell_size == 4 ? a * (7 - a) / 2 + b - a - 1 : 3 - a - b;
}

/* EqmCellLaplacian - the Laplacian of one cell from the weights of its edges; rows and columns beyond `cell_size` are
   zero. Not collective. */
static inline void EqmCellLaplacian(PetscInt cell_size, const PetscReal *weight, PetscReal entry[4][4])
{
  for (PetscInt k = 0; k < 16; k++) entry[k / 4][k % 4] = 0.;
  for (PetscInt e = 0; e < EqmCellNumEdges(cell_size); e++) {
    PetscInt a, b;
    EqmCellEdge(cell_size, e, &a, &b);
    entry[a][a] += weight[e];
    entry[b][b] += weight[e];
    entry[a][b] = entry[b][a] = -weight[e];
  }
}

#endif
