/* CHOLMOD's functions for PETSc's width of integers, and what its users share. */
#ifndef EQM_CHOLMOD_NAME_H
#define EQM_CHOLMOD_NAME_H

#include "linalg/linalg.h"
#include <cholmod.h>

#if defined(PETSC_USE_64BIT_INDICES)
#define CHOLMOD(name) cholmod_l_##name
#else
#define CHOLMOD(name) cholmod_##name
#endif

/* The matrix of a solver on one rank as CHOLMOD reads it, in place; give it back with EqmCholmodRestoreView. Not
   collective. */
PETSC_INTERN PetscErrorCode EqmCholmodGetView(EqmLinear linear, cholmod_sparse *view);
PETSC_INTERN PetscErrorCode EqmCholmodRestoreView(EqmLinear linear, cholmod_sparse *view);
/* The order of elimination on one rank, to be freed: which unknown is the k-th. Not collective. */
PETSC_INTERN PetscErrorCode EqmOrderingOfFactor(EqmLinear linear, EqmOrdering ordering, PetscInt **order);
/* Add what a supernodal factor takes, from its symbolic half: blocks and their rows, the largest update block, a
   permuted copy of the matrix, vectors. Not collective. */
PETSC_INTERN void EqmEstimateCholmod(const cholmod_factor *factor, const cholmod_common *common, EqmEstimate *estimate);

#endif
