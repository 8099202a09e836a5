/* Dense kernels of the multifrontal factor. Several threads may call them at once, which serial builds of OpenBLAS do
   not allow; each number is the result of the same operations in the same order whatever the processor's vectors. All
   matrices are stored by columns, `stride` apart. Not collective. */
#ifndef EQM_DENSE_H
#define EQM_DENSE_H

#include <petscsys.h>

/* Right-hand sides that a call takes at most. */
enum { EQM_MOST_COLUMNS = 4 };

/* Columns begin .. end - 1 of L, rows of the diagonal block only, from a matrix whose columns before `begin` are L
   already. False if the block is not positive definite. */
PETSC_INTERN PetscBool EqmDenseFactorBlock(PetscScalar *matrix, PetscInt stride, PetscInt begin, PetscInt end);
/* The same columns in the rows row_begin .. row_end - 1 below the block. */
PETSC_INTERN void EqmDenseFactorRows(PetscScalar *matrix, PetscInt stride, PetscInt begin, PetscInt end,
                                     PetscInt row_begin, PetscInt row_end);
/* Columns begin .. end - 1 of -B B^T from the diagonal down, B of `rows` x `depth`; they replace those of `update`. */
PETSC_INTERN void EqmDenseUpdate(const PetscScalar *b, PetscInt stride, PetscInt rows, PetscInt depth, PetscInt begin,
                                 PetscInt end, PetscScalar *update);
/* Forward substitution with a trapezoid L of `rows` x `columns`: `x` has `count` columns of `rows`, in which the first
   `columns` rows become the solution and the others lose L times it. */
PETSC_INTERN void EqmDenseForward(const PetscScalar *l, PetscInt rows, PetscInt columns, PetscInt count,
                                  PetscScalar *x);
/* Backward substitution with its transpose: the first `columns` rows of `x` from all of them. */
PETSC_INTERN void EqmDenseBackward(const PetscScalar *l, PetscInt rows, PetscInt columns, PetscInt count,
                                   PetscScalar *x);

/* The same with a factor whose numbers are kept in single precision, half the memory to read; vectors and arithmetic
   are double, so that forward and backward substitution are still each other's transpose to the last digits. */
PETSC_INTERN void EqmDenseForwardSingle(const float *l, PetscInt rows, PetscInt columns, PetscInt count,
                                        PetscScalar *x);
PETSC_INTERN void EqmDenseBackwardSingle(const float *l, PetscInt rows, PetscInt columns, PetscInt count,
                                         PetscScalar *x);
/* Round the lower trapezoid of `l` to single precision; what is above its diagonal is not written. False if a number
   is beyond the range of single precision, or the diagonal below. */
PETSC_INTERN PetscBool EqmDenseNarrow(const PetscScalar *l, PetscInt rows, PetscInt columns, float *narrow);

#endif
