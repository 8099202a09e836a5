/* Square matrices of 2 x 2 blocks in compressed rows: a block for two vertices that share a triangle. A vertex with
   fewer unknowns than two has ones on the diagonal in their place, and nothing beside it. The kernels run on the
   threads; every number is the same for any number of them. */
#ifndef EQM_BLOCKMATRIX_H
#define EQM_BLOCKMATRIX_H

#include "geometry/simplex.h"
#include <petscksp.h>

/* By rows: (0, 0), (0, 1), (1, 0), (1, 1). */
typedef struct {
  PetscReal e[4];
} EqmBlock;

typedef struct {
  PetscInt num_rows;
  PetscInt *start, *column; /* num_rows + 1; start[num_rows] */
  PetscInt *diagonal;       /* per row: where its diagonal block is */
  PetscInt *mirror;         /* per entry before the diagonal: where its transpose is; NULL: not known */
  EqmBlock *entry;          /* start[num_rows] */
} EqmBlockMatrix;

PETSC_INTERN PetscErrorCode EqmBlockMatrixReset(EqmBlockMatrix *matrix);
/* y = A x; vectors have two numbers per row. Not collective. */
PETSC_INTERN void EqmBlockMatrixMultiply(const EqmBlockMatrix *matrix, const PetscReal *x, PetscReal *y);
/* Ones in the place of unknowns that are not there; `success` is false where a diagonal block is not positive definite.
   Not collective. */
PETSC_INTERN PetscErrorCode EqmBlockMatrixCompleteDiagonal(EqmBlockMatrix *matrix, PetscBool *success);

/* PETSc's own Cholesky factor of such a matrix, for some thousand rows. */
typedef struct {
  PetscInt *row, *column, *place; /* scalar rows; where the values are among the matrix's */
  PetscReal *value;
  Mat matrix;
  KSP ksp;
} EqmBlockFactor;
/* The pattern's; then the entries of matrices that have it, again and again. `success` is false where the matrix is not
   positive definite. Not collective. */
PETSC_INTERN PetscErrorCode EqmBlockFactorCreate(const EqmBlockMatrix *pattern, EqmBlockFactor *factor);
PETSC_INTERN PetscErrorCode EqmBlockFactorDestroy(EqmBlockFactor *factor);
PETSC_INTERN PetscErrorCode EqmBlockFactorFill(const EqmBlockMatrix *matrix, EqmBlockFactor *factor,
                                               PetscBool *success);
PETSC_INTERN PetscErrorCode EqmBlockFactorSolve(const EqmBlockFactor *factor, const PetscReal *b, PetscReal *x,
                                                PetscBool *success);

/* c += a b, and c += a^T b. */
static inline void EqmBlockAddProduct(const EqmBlock *a, const EqmBlock *b, EqmBlock *c)
{
  c->e[0] += a->e[0] * b->e[0] + a->e[1] * b->e[2];
  c->e[1] += a->e[0] * b->e[1] + a->e[1] * b->e[3];
  c->e[2] += a->e[2] * b->e[0] + a->e[3] * b->e[2];
  c->e[3] += a->e[2] * b->e[1] + a->e[3] * b->e[3];
}

static inline void EqmBlockAddTransposedProduct(const EqmBlock *a, const EqmBlock *b, EqmBlock *c)
{
  c->e[0] += a->e[0] * b->e[0] + a->e[2] * b->e[2];
  c->e[1] += a->e[0] * b->e[1] + a->e[2] * b->e[3];
  c->e[2] += a->e[1] * b->e[0] + a->e[3] * b->e[2];
  c->e[3] += a->e[1] * b->e[1] + a->e[3] * b->e[3];
}

/* Sums of products with the two rows of blocks, each as its two halves that are yet to be added. */
typedef struct {
  EqmPoint2 row[2];
} EqmBlockSum;

static inline void EqmBlockSumAdd(EqmBlockSum *sum, const EqmBlock *a, const PetscReal *x)
{
  const EqmPoint2 *const e = (const EqmPoint2 *)a->e, y = *(const EqmPoint2 *)x;

  sum->row[0] += e[0] * y;
  sum->row[1] += e[1] * y;
}

/* y += a x, and y += a^T x. */
static inline void EqmBlockAddApplied(const EqmBlock *a, const PetscReal *x, PetscReal y[2])
{
  y[0] += a->e[0] * x[0] + a->e[1] * x[1];
  y[1] += a->e[2] * x[0] + a->e[3] * x[1];
}

static inline void EqmBlockAddTransposedApplied(const EqmBlock *a, const PetscReal *x, PetscReal y[2])
{
  y[0] += a->e[0] * x[0] + a->e[2] * x[1];
  y[1] += a->e[1] * x[0] + a->e[3] * x[1];
}

#endif
