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
   is the k-th to eliminate. Errors: PETSC_ERR_MEM. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalCreate(const cholmod_sparse *pattern, PetscInt *order, EqmFrontal *frontal);
PETSC_INTERN PetscErrorCode EqmFrontalDestroy(EqmFrontal *frontal);
/* Add what the factor takes to an estimate. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalGetCost(EqmFrontal frontal, EqmEstimate *estimate);
/* New values, in the order of the pattern's entries. `success` is false if the matrix is not positive definite. Errors:
   PETSC_ERR_MEM. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalFactor(EqmFrontal frontal, const PetscScalar *value, PetscBool *success);
/* x = A^-1 b for columns of the unknowns, stored one after the other; x and b may be the same array. Errors:
   PETSC_ERR_MEM. Not collective. */
PETSC_INTERN PetscErrorCode EqmFrontalSolve(EqmFrontal frontal, PetscInt num_rhs, const PetscScalar *b, PetscScalar *x);

#endif
