/* Sparse Cholesky factors by the multifrontal method, on the threads of one rank. */
#ifndef EQM_FRONTAL_H
#define EQM_FRONTAL_H

#include "linalg/cholmod_name.h"

/* A factor L L^T of a symmetric positive definite matrix: a dense front for every supernode of the elimination tree,
   which takes what is left of the fronts below it (I. S. Duff, J. K. Reid, ACM TOMS 9, 1983). Fronts of different
   branches go to different threads; every sum has one order, that of the tree, so that the same bits come out for any
   number of threads. */
typedef struct _p_EqmFrontal *EqmFrontal;

/* Symbolic work. `pattern`: the upper triangle by columns, rows sorted, values not looked at; `order[k]`: which unknown
   is the k-th to eliminate. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalCreate(const cholmod_sparse *pattern, PetscInt *order, EqmFrontal *frontal);
/* Keep the factors to come in single precision: half the memory, and nearly half the time of a solve, which is then one
   with a symmetric definite matrix close to A. Factorisations are in double precision as before. Before the first
   factorisation. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalKeepSingle(EqmFrontal frontal);
PETSC_INTERN PetscErrorCode EqmFrontalDestroy(EqmFrontal *frontal);
/* Had the last call the memory that it needed? Else nothing but EqmFrontalDestroy may follow. Not collective. */
PETSC_INTERN PetscBool EqmFrontalHasMemory(EqmFrontal frontal);
/* Add what the factor takes to an estimate. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalGetCost(EqmFrontal frontal, EqmEstimate *estimate);
/* New values, in the order of the pattern's entries. `success` is false if the matrix is not positive definite, or
   its factor beyond the range of single precision where that is kept. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalFactor(EqmFrontal frontal, const PetscScalar *value, PetscBool *success);

/* With P the permutation to the order of elimination, P A P^T = L L^T. */
typedef enum {
  EQM_SOLVE_FORWARD = 1,  /* x = P^T L^-1 P b */
  EQM_SOLVE_BACKWARD = 2, /* x = P^T L^-T P b */
  EQM_SOLVE_BOTH = 3      /* x = A^-1 b */
} EqmSolveHalf;
/* Solve for columns of the unknowns, stored one after the other; x and b may be the same array. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalSolve(EqmFrontal frontal, EqmSolveHalf half, PetscInt num_rhs,
                                            const PetscScalar *b, PetscScalar *x);
/* Where each unknown stands in the order of elimination. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalGetPositions(EqmFrontal frontal, const PetscInt **position);
/* Factorisations to come leave in `block` the dense block of L at `n` unknowns, by columns and in double precision:
   `at` says per position which row and column of it, -1 if none. Both arrays must outlive the factor. Not collective.
 */
PETSC_INTERN PetscErrorCode EqmFrontalKeepBlock(EqmFrontal frontal, PetscInt n, const PetscInt *at, PetscScalar *block);

#endif
