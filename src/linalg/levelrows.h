/* What a rank has, in the form in which it goes to a hierarchy's first rank and comes back: matrices of triangles
   packed, two numbers per vertex. Not collective. */
#ifndef EQM_LEVELROWS_H
#define EQM_LEVELROWS_H

#include "linalg/linalg.h"

enum {
  EQM_MOST_TRIANGLE_SIZE = 6,
  EQM_PACKED_TRIANGLE = 21
}; /* unknowns of a triangle; entries of their matrix's upper triangle */

/* A cell's matrix as the upper triangle of EQM_MOST_TRIANGLE_SIZE rows, of which those beyond its unknowns are left
 * out. */
static inline void EqmTrianglePack(PetscInt size, const PetscReal *matrix, PetscReal packed[EQM_PACKED_TRIANGLE])
{
  for (PetscInt i = 0, n = 0; i < size; i++) {
    for (PetscInt j = i; j < size; j++) packed[n++] = matrix[size * i + j];
  }
}

static inline void EqmTriangleUnpack(PetscInt size, const PetscReal packed[EQM_PACKED_TRIANGLE], PetscReal *matrix)
{
  for (PetscInt i = 0, n = 0; i < size; i++) {
    for (PetscInt j = i; j < size; j++) matrix[size * i + j] = matrix[size * j + i] = packed[n++];
  }
}

/* From the unknowns of the owned vertices, the first num_vertices, to two numbers each, and back. */
static inline void EqmUnknownsSpread(const EqmUnknowns *u, PetscInt num_vertices, const PetscReal *unknowns,
                                     PetscReal *owned)
{
  for (PetscInt v = 0; v < num_vertices; v++) {
    for (PetscInt k = 0; k < 2; k++) owned[2 * v + k] = k < u->count[v] ? unknowns[u->start[v] - u->first + k] : 0.;
  }
}

static inline void EqmUnknownsCollect(const EqmUnknowns *u, PetscInt num_vertices, const PetscReal *owned,
                                      PetscReal *unknowns)
{
  for (PetscInt v = 0; v < num_vertices; v++) {
    for (PetscInt k = 0; k < u->count[v]; k++) unknowns[u->start[v] - u->first + k] = owned[2 * v + k];
  }
}

#endif
