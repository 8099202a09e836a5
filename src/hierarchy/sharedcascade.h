#ifndef EQM_SHAREDCASCADE_H
#define EQM_SHAREDCASCADE_H

#include "hierarchy/cascade.h"
#include "hierarchy/shared.h"

/* As EqmCascade, on shared levels: the first rank maps what is below them, then all ranks put vertices back and relax.
   `x`: per vertex of the mesh that this rank owns, those of boundary vertices set on entry. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedCascade(EqmShared shared, EqmCascadeTarget target,
                                             const EqmCascadeOptions *options, PetscReal *x, EqmCascadeResult *result);

#endif
