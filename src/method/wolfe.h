/* Step lengths by the strong Wolfe conditions. */
#ifndef EQM_WOLFE_H
#define EQM_WOLFE_H

#include <petscsys.h>

/* Value and slope of a function of the step length; the caller keeps the rest of the trial. Collective. */
typedef PetscErrorCode (*EqmTryStep)(void *context, PetscReal t, PetscReal *value, PetscReal *slope);

PETSC_INTERN PetscErrorCode EqmWolfeSearch(EqmTryStep try_step, void *context, PetscReal value, PetscReal slope,
                                           PetscReal *t, PetscReal *new_value);

#endif
