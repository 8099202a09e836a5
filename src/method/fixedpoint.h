/* What the files of the fixed-point iteration share. */
#ifndef EQM_FIXEDPOINT_H
#define EQM_FIXEDPOINT_H

#include "method/method.h"

typedef struct {
  PetscEnum stop; /* a FixedPointStop */
  PetscReal eps;
  PetscBool ended; /* the last step met eps */
  PetscReal *weights, *columns, *inverted;
  signed char *group;
  EqmPlace to, before;
} EqmFixedPoint;

/* One step of 000 (49): interior vertices of the disk from stretch weights, landmarks drawn to their places with the
   problem's lambda, the boundary where it is. Factors. Collective. */
PETSC_INTERN PetscErrorCode EqmFixedPointDraw(EqmProblem problem, const PetscReal *weights, EqmPlace *place);
/* One pass of 000 (14) in the order that reproduces the published table: boundary first, then the interior with the new
   boundary, both with L_S of the old map, whose weights are set. Factors. Collective. */
PETSC_INTERN PetscErrorCode EqmFixedPointStepOnDisk(EqmMethod method, EqmIterate iterate);

#endif
