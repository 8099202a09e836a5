/* Limited memory of steps and gradient changes, for quasi-Newton directions. */
#ifndef EQM_PAIRS_H
#define EQM_PAIRS_H

#include <petscvec.h>
#include "problem/state.h"

/* q <- H0 q: the inverse Hessian that the pairs correct. Collective. */
typedef PetscErrorCode (*EqmApplyInverse)(void *context, Vec q);

typedef struct _p_EqmPairs *EqmPairs;
PETSC_INTERN PetscErrorCode EqmPairsCreate(Vec like, PetscInt most, EqmPairs *pairs);
PETSC_INTERN PetscErrorCode EqmPairsDestroy(EqmPairs *pairs);
PETSC_INTERN PetscErrorCode EqmPairsForget(EqmPairs pairs);
PETSC_INTERN PetscErrorCode EqmPairsAdd(EqmPairs pairs, PetscReal scale, Vec step, Vec old_gradient, Vec new_gradient);
PETSC_INTERN PetscErrorCode EqmPairsDirection(EqmPairs pairs, EqmApplyInverse apply, void *context, Vec q);
/* How a vector of the kind that the pairs are made of is named in a state. */
typedef PetscErrorCode (*EqmStateVec)(EqmState state, void *context, const char *name, Vec v);
/* For the `state` of a method that keeps its pairs from step to step. Collective. */
PETSC_INTERN PetscErrorCode EqmPairsState(EqmPairs pairs, EqmState state, EqmStateVec visit, void *context);
/* The same, for degrees of freedom of a domain. Collective. */
PETSC_INTERN PetscErrorCode EqmPairsStateDofs(EqmPairs pairs, EqmState state, EqmDomain domain);

#endif
