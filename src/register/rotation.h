/* Rotations that bring points onto each other. */
#ifndef EQM_ROTATION_H
#define EQM_ROTATION_H

#include <petscsys.h>

/* The rotation R (dim x dim, by rows, det R = +1) that makes sum w |R p - q|^2 least, from the correlation
   C = sum w q p^T by rows. Not collective. */
PETSC_INTERN PetscErrorCode EqmBestRotation(PetscInt dim, const PetscReal *correlation, PetscReal *rotation);
/* x <- R x for `count` points of `dim` coordinates. Not collective. */
PETSC_INTERN void EqmRotate(PetscInt dim, const PetscReal *rotation, PetscInt count, PetscReal *x);

#endif
