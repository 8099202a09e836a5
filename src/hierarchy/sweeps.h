/* Gauss-Seidel sweeps with a block matrix, in single precision: smoothers of multigrid, which move half as much memory
   so. Rows fall into pieces of consecutive ones, whose number depends on the matrix alone; a thread sweeps a piece,
   without the entries that lead to other pieces, or to rows that other ranks have. So that the sweep forward and then
   its transpose make a symmetric definite operator all the same, half the norms of those entries are added to the
   diagonal (A. H. Baker, R. D. Falgout, T. V. Kolev, U. M. Yang, SIAM J. Sci. Comput. 33, 2011, section 5). */
#ifndef EQM_SWEEPS_H
#define EQM_SWEEPS_H

#include "hierarchy/blockmatrix.h"

typedef struct {
  float e[4];
} EqmSingleBlock;

typedef struct {
  PetscInt num_rows, num_pieces, *piece_start; /* num_pieces + 1 */
  PetscInt *part;   /* row i has from part[3 i] on columns before i in its piece, from part[3 i + 1] on those behind it
                       in its piece, from part[3 i + 2] on those of other pieces; the next row follows */
  PetscInt *column; /* without the diagonal */
  PetscInt *place;  /* where the entries are in the matrix */
  EqmSingleBlock *entry, *diagonal;
  EqmBlock *inverse; /* per row: of the diagonal block, enlarged */
} EqmSweeps;

/* For matrices of this pattern, whose columns from num_rows on are other ranks'. Not collective. */
PETSC_INTERN PetscErrorCode EqmSweepsCreate(const EqmBlockMatrix *pattern, PetscInt num_pieces,
                                            const PetscInt *piece_start, EqmSweeps *sweeps);
/* The same in pieces of some thousand rows. Not collective. */
PETSC_INTERN PetscErrorCode EqmSweepsCreateEven(const EqmBlockMatrix *pattern, EqmSweeps *sweeps);
PETSC_INTERN PetscErrorCode EqmSweepsDestroy(EqmSweeps *sweeps);
/* Take the entries of a matrix, whose diagonal is complete (EqmBlockMatrixCompleteDiagonal). Not collective. */
PETSC_INTERN void EqmSweepsFill(EqmSweeps *sweeps, const EqmBlockMatrix *matrix);
/* x = M^-1 b, M the lower triangles of the pieces; then, with other ranks' entries in x, r = b - A x: r goes from one
   to the other. Not collective. */
PETSC_INTERN void EqmSweepForward(const EqmSweeps *sweeps, const PetscReal *b, PetscReal *x, PetscReal *r);
PETSC_INTERN void EqmSweepResidual(const EqmSweeps *sweeps, const PetscReal *x, PetscReal *r);
/* x += M^-T (b - A x); r is scratch. Not collective. */
PETSC_INTERN void EqmSweepBackward(const EqmSweeps *sweeps, const PetscReal *b, PetscReal *x, PetscReal *r);

#endif
