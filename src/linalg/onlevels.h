#ifndef EQM_ONLEVELS_H
#define EQM_ONLEVELS_H

#include "hierarchy/cycle.h"
#include "linalg/linalg.h"

/* -linear_solver hierarchy: a solver on the levels of a surface's hierarchy, which must outlive it, for at most two
   unknowns per vertex: coordinates of motions of a map to `target` (EqmLinearSetImage). Collective. */
PETSC_INTERN PetscErrorCode EqmLinearCreateOnLevels(EqmMesh mesh, const EqmUnknowns *unknowns, EqmHierarchy hierarchy,
                                                    EqmCascadeTarget target, EqmLinear *linear);

#endif
