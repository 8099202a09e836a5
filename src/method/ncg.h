/* What the two files of the conjugate gradient method share. */
#ifndef EQM_NCG_H
#define EQM_NCG_H

#include "method/method.h"

enum { EQM_NCG_FLETCHER_REEVES, EQM_NCG_POLAK_RIBIERE, EQM_NCG_HAGER_ZHANG };
enum { EQM_NCG_GUARDED, EQM_NCG_PRINTED, EQM_NCG_WOLFE };

typedef struct {
  PetscInt refresh;
  PetscEnum beta, search; /* of the two lists above */
  PetscReal c2;           /* of the strong Wolfe conditions */
  Vec gradient, preconditioned, direction, old_gradient, old_preconditioned, trial_gradient;
  EqmMetric metric;
  PetscReal *image;
  EqmPlace trial;
  PetscReal alpha; /* the last step length */
} Ncg;

/* The step length along ncg->direction, whose slope at the iterate is `slope`: 0 where there is none. Leaves place,
   image and gradient of the step in the trial, its value in `energy`. Collective. */
PETSC_INTERN PetscErrorCode EqmNcgSearch(EqmMethod method, EqmIterate iterate, PetscReal slope, PetscReal *alpha,
                                         PetscReal *energy);

#endif
