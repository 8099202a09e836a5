/* Rotations that bring points onto each other. */
#ifndef EQM_ROTATION_H
#define EQM_ROTATION_H

#include <petscsys.h>

/* The rotation R (dim x dim, by rows, det R = +1) that makes sum w |R p - q|^2 least, from the correlation
   C = sum w q p^T by rows. Not collective. */
PETSC_INTERN PetscErrorCode EqmBestRotation(PetscInt dim, const PetscReal *correlation, PetscReal *rotation);
/* The rotation (3 x 3, by rows) of a unit quaternion, real part first. Not collective. */
PETSC_INTERN void EqmRotationOfQuaternion(const PetscReal q[4], PetscReal rotation[9]);
/* x <- R x for `count` points of `dim` coordinates. Not collective. */
PETSC_INTERN void EqmRotate(PetscInt dim, const PetscReal *rotation, PetscInt count, PetscReal *x);

#endif
