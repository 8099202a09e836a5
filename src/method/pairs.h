/* Limited memory of steps and gradient changes, for quasi-Newton directions. */
#ifndef EQM_PAIRS_H
#define EQM_PAIRS_H

#include <petscvec.h>

/* q <- H0 q: the inverse Hessian that the pairs correct. Collective. */
typedef PetscErrorCode (*EqmApplyInverse)(void *context, Vec q);

typedef struct _p_EqmPairs *EqmPairs;
PETSC_INTERN PetscErrorCode EqmPairsCreate(Vec like, PetscInt most, EqmPairs *pairs);
PETSC_INTERN PetscErrorCode EqmPairsDestroy(EqmPairs *pairs);
PETSC_INTERN PetscErrorCode EqmPairsForget(EqmPairs pairs);
PETSC_INTERN PetscErrorCode EqmPairsAdd(EqmPairs pairs, PetscReal scale, Vec step, Vec old_gradient, Vec new_gradient);
PETSC_INTERN PetscErrorCode EqmPairsDirection(EqmPairs pairs, EqmApplyInverse apply, void *context, Vec q);

#endif
