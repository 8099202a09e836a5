/* Area-preserving flows that carry landmarks to their places. */
#ifndef EQM_LANDMARK_FLOW_H
#define EQM_LANDMARK_FLOW_H

#include <petscsys.h>

/* Carry `count` points of the disk (dim 2) or the sphere (dim 3) along a smooth flow that preserves area and brings the
   landmarks, now at `from`, to `to` (`num` each, the same on every rank). `reach`: length scale of the kernel, in radii
   of the target. `left`: the largest distance that remains. Not collective. */
PETSC_INTERN PetscErrorCode EqmLandmarkFlow(PetscInt dim, PetscReal reach, PetscInt num, const PetscReal *from,
                                            const PetscReal *to, PetscInt count, PetscReal *x, PetscReal *left);

#endif
