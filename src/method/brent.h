/* The minimum of a function of one variable, from its values alone. */
#ifndef EQM_BRENT_H
#define EQM_BRENT_H

#include <petscsys.h>

/* Collective. */
typedef PetscErrorCode (*EqmFunction)(void *context, PetscReal t, PetscReal *value);

PETSC_INTERN PetscErrorCode EqmBrentSearch(EqmFunction function, void *context, PetscReal *t, PetscReal *value);

#endif
