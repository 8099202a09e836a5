/* Products and sums of vectors on the threads, with the same bits for any number of them. */
#ifndef EQM_VECTORS_H
#define EQM_VECTORS_H

#include <petscvec.h>

/* As VecMDot: product[k] = x . y[k]. Collective. */
PETSC_INTERN PetscErrorCode EqmVecProducts(Vec x, PetscInt count, const Vec *y, PetscReal *product);
/* As VecMAXPY: x += sum of factor[k] y[k]. Not collective. */
PETSC_INTERN PetscErrorCode EqmVecAddMultiples(Vec x, PetscInt count, const PetscReal *factor, const Vec *y);

#endif
