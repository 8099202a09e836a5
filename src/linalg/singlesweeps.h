/* Symmetric Gauss-Seidel sweeps with the blocks of EqmSingleRows. Rows fall into pieces of consecutive ones, whose
   number depends on the matrix alone; a thread sweeps a piece, without the blocks that lead to other pieces, or to rows
   that other ranks have.

   A cycle with such sweeps is definite if 2 M - A is (src/hierarchy/sweeps.h has a bound for blocks of two). M is more
   than the blocks B within pieces, so B - O > 0 is enough, O what is between pieces. The matrix is a sum of
   semidefinite ones of cells: of a cell in two pieces O is no more than B, as it is B + O with another sign of one
   piece's unknowns. In three or more it may be. Rows with neighbours in two other pieces, as all of such a cell are,
   therefore have half the norms of their blocks between pieces added to the diagonal (A. H. Baker, R. D. Falgout, T. V.
   Kolev, U. M. Yang, SIAM J. Sci. Comput. 33, 2011, section 5); added everywhere they would cost a tenth of the
   iterations more. */
#ifndef EQM_SINGLESWEEPS_H
#define EQM_SINGLESWEEPS_H

#include "linalg/singlerows.h"

typedef struct {
  EqmSingleRows *rows;
  PetscInt num_pieces;
  PetscInt *diagonal, *beyond; /* per row: its diagonal block, and the first of those that lead out of its piece;
                                  before and between these are the columns of its piece */
  unsigned char *meets;        /* per row: has it columns of two pieces, or more, beside its own? */
  float *added;                /* per row: to the diagonal */
  float *inverse;              /* per row: of the diagonal block, enlarged; three more at the end */
} EqmSingleSweeps;

/* For square rows with diagonal, whose columns are reordered. Collective. */
PETSC_INTERN PetscErrorCode EqmSingleSweepsCreate(EqmSingleRows *rows, EqmSingleSweeps *sweeps);
PETSC_INTERN PetscErrorCode EqmSingleSweepsDestroy(EqmSingleSweeps *sweeps);
/* Diagonals of the rows' present entries. `finite` is false on a rank where some inverse is not. Not collective. */
PETSC_INTERN void EqmSingleSweepsFill(EqmSingleSweeps *sweeps, PetscBool *finite);
/* x = M^-1 b, M = (D + L) D^-1 (D + U) of the pieces, D enlarged; t is kept for the residual. Not collective. */
PETSC_INTERN void EqmSingleSweepBefore(const EqmSingleSweeps *sweeps, const float *b, float *x, float *t);
/* r = b - A x of that x, with its ghosts; r may be t. Not collective. */
PETSC_INTERN void EqmSingleSweepResidual(const EqmSingleSweeps *sweeps, const float *b, const float *x, const float *t,
                                         float *r);
/* x += M^-1 (b - A x), x with its ghosts; `old`, as long as x with them, and t are scratch. Not collective. */
PETSC_INTERN void EqmSingleSweepAfter(const EqmSingleSweeps *sweeps, const float *b, float *x, float *old, float *t);

#endif
