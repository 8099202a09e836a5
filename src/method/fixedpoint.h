/* What the two files of the fixed-point iteration share. */
#ifndef EQM_FIXEDPOINT_H
#define EQM_FIXEDPOINT_H

#include "method/method.h"

/* One step of 000 (49): interior vertices of the disk from stretch weights, landmarks drawn to their places with the
   problem's lambda, the boundary where it is. Factors. Collective. */
PETSC_INTERN PetscErrorCode EqmFixedPointDraw(EqmProblem problem, const PetscReal *weights, EqmPlace *place);

#endif
