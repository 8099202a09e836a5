/* The part of a Galerkin matrix of solenoidal motions that cells add which meet the same splines: a dense block. */
#ifndef EQM_SOLENOIDAL_BLOCK_H
#define EQM_SOLENOIDAL_BLOCK_H

#include "problem/solenoidal_private.h"

/* The splines that a cell meets: width[k] in each direction from begin[k] on. */
typedef struct {
  PetscInt begin[3], width[3];
} EqmSplineRange;

/* What a thread works with: the sum of r r^T over rows r, which are multiplied many at once. Columns are the first
   fields of all splines of the range, in the order of their places, then the second ones, ... */
typedef struct {
  EqmSplineRange range;
  PetscInt columns, depth;          /* how many rows wait */
  PetscScalar *row, *product, *sum; /* these; their products; the sum, from the diagonal down */
} EqmSplineBlock;

PETSC_INTERN PetscInt EqmSplineRangeColumns(const EqmSplineRange *range);
/* Numbers that a block of so many columns takes. */
PETSC_INTERN PetscInt EqmSplineBlockRoom(PetscInt columns);
/* A block of zeros. Not collective, nor are the others. */
PETSC_INTERN void EqmSplineBlockBegin(const EqmSplineRange *range, PetscScalar *room, EqmSplineBlock *block);
/* Add factor g g^T, g the gradient of a tetrahedron's volume with corners p, `splines` those at the corners. */
PETSC_INTERN void EqmSplineBlockAddVolume(EqmSplineBlock *block, const PetscReal *const p[4],
                                          const EqmSplines splines[4], PetscReal factor);
/* Add factor L in each coordinate, L the tetrahedron's Laplacian with these weights of its edges. */
PETSC_INTERN void EqmSplineBlockAddLaplacian(EqmSplineBlock *block, const PetscReal *const p[4],
                                             const EqmSplines splines[4], const PetscReal *weights, PetscReal factor);
/* Now the sum has all rows. */
PETSC_INTERN void EqmSplineBlockEnd(EqmSplineBlock *block);

#endif
