/* Step lengths by the strong Wolfe conditions. */
#ifndef EQM_WOLFE_H
#define EQM_WOLFE_H

#include <petscsys.h>

/* Value and slope of a function of the step length; the caller keeps the rest of the trial. Collective. */
typedef PetscErrorCode (*EqmTryStep)(void *context, PetscReal t, PetscReal *value, PetscReal *slope);

/* c2 of quasi-Newton methods; conjugate gradients need one below 1/2 (000 Corollary 1). */
#define EQM_WOLFE_FLATNESS .9

/* A step length t with value(t) <= value + 1e-4 t slope and |slope(t)| <= flatness |slope|. Collective. */
PETSC_INTERN PetscErrorCode EqmWolfeSearch(EqmTryStep try_step, void *context, PetscReal value, PetscReal slope,
                                           PetscReal flatness, PetscReal *t, PetscReal *new_value);

#endif
