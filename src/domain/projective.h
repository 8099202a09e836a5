/* Mobius maps of the sphere as matrices: (u, v) -> M (u, v) where u/v is the stereographic image of a point, so that
   composition is a product and no point is at infinity. */
#ifndef EQM_PROJECTIVE_H
#define EQM_PROJECTIVE_H

#include <equimap/domain.h>
#include <complex.h>

typedef struct {
  double complex m[4]; /* by rows */
} EqmMoebius;

/* y = image of x; may be the same. Not collective. */
PETSC_INTERN void EqmMoebiusApply(const EqmMoebius *map, const PetscReal x[3], PetscReal y[3]);
/* The map that takes the three points p (3 each, different) to the three points q. Not collective. */
PETSC_INTERN EqmMoebius EqmMoebiusThrough(const PetscReal p[9], const PetscReal q[9]);
/* The flow for unit time of the conformal field rotation x x + dilation - (dilation . x) x. Not collective. */
PETSC_INTERN EqmMoebius EqmMoebiusExponential(const PetscReal rotation[3], const PetscReal dilation[3]);
/* First b, then a. Not collective. */
PETSC_INTERN EqmMoebius EqmMoebiusProduct(const EqmMoebius *a, const EqmMoebius *b);
/* The map that brings points x to points q (3 each) as closely as it can: sum |M x - q|^2 least. With fewer than three
   points, or if `rigid`, a rotation. `distance`: root mean square of what is left. Not collective. */
PETSC_INTERN PetscErrorCode EqmMoebiusAlign(PetscInt count, const PetscReal *x, const PetscReal *q, PetscBool rigid,
                                            EqmMoebius *map, PetscReal *distance);
/* Apply to all places and choose new frames. Not collective. */
PETSC_INTERN PetscErrorCode EqmPlaceTransform(EqmDomain domain, const EqmMoebius *map, EqmPlace *place);

#endif
