/* A penalty on small and negative volumes, for maps to the ball. */
#ifndef EQM_HINGE_H
#define EQM_HINGE_H

#include "method/method.h"

PETSC_INTERN PetscErrorCode EqmHingeCreate(EqmSolver solver, EqmHinge *hinge);
PETSC_INTERN PetscErrorCode EqmHingeDestroy(EqmHinge *hinge);
/* By how much the hinge multiplies the Gauss-Newton term of a cell with the given weight and image measure; 0 without a
   hinge. Not collective. */
PETSC_INTERN PetscReal EqmHingeStiffness(EqmHinge hinge, PetscReal weight, PetscReal measure);
/* Add the penalty and its gradient; `image` holds the measures at `place`. Collective. */
PETSC_INTERN PetscErrorCode EqmHingeAdd(EqmSolver solver, EqmHinge hinge, const EqmPlace *place, const PetscReal *image,
                                        PetscReal *value, Vec gradient);

#endif
