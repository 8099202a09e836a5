/* Some vertices of A, the same for any number of ranks, carried to B under several rotations at once. */
#ifndef EQM_SAMPLE_H
#define EQM_SAMPLE_H

#include "register/registration.h"

typedef struct {
  EqmRegistration r;
  EqmLocator locator;     /* of g(B) */
  PetscInt dim, count;    /* coordinates in the target; vertices of this rank */
  PetscReal *place;       /* f, dim each */
  PetscReal *point;       /* in space, about their mean, scaled to B's measure */
  PetscReal *root_weight; /* square roots of weights that add up to one */
} EqmSample;

/* About `size` vertices. Collective. */
PETSC_INTERN PetscErrorCode EqmSampleCreate(EqmRegistration r, PetscInt size, EqmSample *sample);
PETSC_INTERN PetscErrorCode EqmSampleDestroy(EqmSample *sample);
/* For each of `num` rotations (dim x dim, by rows) of A's map: sqrt(w) (Q v - phi(v)) with the best rigid motion Q, in
   radii of B, three reals for each vertex of the sample, and the sum of their squares. Collective. */
PETSC_INTERN PetscErrorCode EqmSampleResiduals(const EqmSample *sample, PetscInt num, const PetscReal *rotations,
                                               PetscReal *residuals, PetscReal *squares);

#endif
