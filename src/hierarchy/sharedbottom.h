/* What the first rank has of multigrid on shared levels: a cycle on the hierarchy that goes on below them. */
#ifndef EQM_SHAREDBOTTOM_H
#define EQM_SHAREDBOTTOM_H

#include "hierarchy/cycle.h"
#include "hierarchy/shared.h"

typedef struct _p_EqmSharedBottom *EqmSharedBottom;
/* Prolongations at a map of the last shared level, down to a level of no more than `most` vertices. `matrix`, which
   must outlive it: all rows are the first rank's. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedBottomCreate(EqmShared shared, EqmCascadeTarget target, const EqmLevelMap *last,
                                                  PetscInt most, const EqmBlockMatrix *matrix, EqmSharedBottom *bottom);
PETSC_INTERN PetscErrorCode EqmSharedBottomDestroy(EqmSharedBottom *bottom);
/* As EqmCycleFill. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedBottomFill(EqmSharedBottom bottom, PetscBool *success);
/* One cycle from zero; b, and x, which stays the bottom's, are the first rank's alone. Not collective. */
PETSC_INTERN PetscErrorCode EqmSharedBottomApply(EqmSharedBottom bottom, const PetscReal *b, PetscReal **x);

#endif
