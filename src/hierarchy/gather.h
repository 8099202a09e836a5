/* The finest level, from the mesh to the first rank. */
#ifndef EQM_GATHER_H
#define EQM_GATHER_H

#include "hierarchy/hierarchy.h"

/* Fill level 0 and its order; `corner` per local vertex or NULL. Collective. */
PETSC_INTERN PetscErrorCode EqmGatherFinest(EqmMesh mesh, const PetscBool *corner, EqmHierarchy hierarchy);

#endif
