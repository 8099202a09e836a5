#ifndef EQM_ONSHARED_H
#define EQM_ONSHARED_H

#include "hierarchy/sharedcycle.h"
#include "linalg/linalg.h"

/* As EqmLinearCreateOnLevels, on levels that all ranks share, of which there are two or more. Collective. */
PETSC_INTERN PetscErrorCode EqmLinearCreateOnShared(EqmMesh mesh, const EqmUnknowns *unknowns, EqmShared shared,
                                                    EqmCascadeTarget target, EqmLinear *linear);

#endif
