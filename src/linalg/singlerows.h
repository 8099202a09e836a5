/* Matrices of 3 x 3 blocks in single precision, as multigrid's cycles read them again and again: the rows of this rank;
   columns that other ranks have come behind its own, as ghosts. Vectors have four numbers per row, the last one
   anything. The kernels run on the threads; every number is the same for any number of them. */
#ifndef EQM_SINGLEROWS_H
#define EQM_SINGLEROWS_H

#include "linalg/dense_vectors.h"
#include <petscmat.h>

enum { EQM_SINGLE_BLOCK = 9, EQM_SINGLE_WIDTH = 4 };

typedef struct {
  PetscInt num_rows, num_columns, num_ghosts; /* in blocks; columns without the ghosts */
  PetscInt *start, *column;                   /* num_rows + 1; start[num_rows] */
  PetscInt *ghost_of;                         /* per column of the matrix's second part: its block's */
  float *entry;                               /* nine per block, by columns, and three more at the end */
  PetscSF halo;                               /* from columns to ghosts; NULL on one rank */
} EqmSingleRows;

/* Has the matrix three rows and columns for every block on every rank? Collective. */
PETSC_INTERN PetscErrorCode EqmSingleRowsFit(Mat matrix, PetscBool *fit);
/* The pattern of such a matrix; with blocks on the diagonal, if asked for, even where it has none. Collective. */
PETSC_INTERN PetscErrorCode EqmSingleRowsCreate(Mat matrix, PetscBool with_diagonal, EqmSingleRows *rows);
PETSC_INTERN PetscErrorCode EqmSingleRowsDestroy(EqmSingleRows *rows);
/* Take the entries of a matrix of that pattern, whose columns may have been reordered within rows since. `finite` is
   false on a rank where some are none in single precision. Not collective. */
PETSC_INTERN PetscErrorCode EqmSingleRowsFill(Mat matrix, EqmSingleRows *rows, PetscBool *finite);
/* Multiply all entries. Not collective. */
PETSC_INTERN void EqmSingleRowsScale(float factor, EqmSingleRows *rows);
/* Other ranks' numbers behind this rank's. Collective. */
PETSC_INTERN PetscErrorCode EqmSingleRowsUpdateGhosts(const EqmSingleRows *rows, float *x);
/* y = A x, or y += A x. Not collective. */
PETSC_INTERN void EqmSingleRowsMultiply(const EqmSingleRows *rows, const float *x, PetscBool add, float *y);

EQM_INLINE Single4 EqmSingleLoad(const float *x)
{
  return *(const Single4 *)x;
}

EQM_INLINE void EqmSingleStore(float *x, Single4 value)
{
  *(Single4 *)x = value;
}

/* The blocks from `begin` to `end` times x. What is read behind a column of three comes into the fourth number. Three
   sums wait less for each other than one. */
EQM_INLINE Single4 EqmSingleProduct(const EqmSingleRows *rows, PetscInt begin, PetscInt end, const float *x)
{
  Single4 sum[3] = {{0.F}, {0.F}, {0.F}};

  for (PetscInt q = begin; q < end; q++) {
    const float *const e = rows->entry + EQM_SINGLE_BLOCK * q, *const y = x + EQM_SINGLE_WIDTH * rows->column[q];
    for (int k = 0; k < 3; k++) sum[k] += EqmSingleLoad(e + 3 * k) * y[k];
  }
  return sum[0] + sum[1] + sum[2];
}

#endif
