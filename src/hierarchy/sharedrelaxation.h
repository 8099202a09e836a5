/* Relaxation of maps of a shared level, again and again: what depends on the mesh alone is kept, and so are multigrid's
   prolongations and patterns until they are wanted anew. */
#ifndef EQM_SHAREDRELAXATION_H
#define EQM_SHAREDRELAXATION_H

#include "hierarchy/balance.h"
#include "hierarchy/sharedcycle.h"

typedef struct _p_EqmSharedRelaxation *EqmSharedRelaxation;
/* Of maps of level k, which is not the last shared one; `map` must outlive it. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRelaxationCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target,
                                                      EqmLevelMap *map, EqmSharedRelaxation *relaxation);
PETSC_INTERN PetscErrorCode EqmSharedRelaxationDestroy(EqmSharedRelaxation *relaxation);
/* Prolongations at the present map, down to a level of no more than `most` vertices; without this they are those of
   the first step. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRelaxationSetImage(EqmSharedRelaxation relaxation, PetscInt most);
/* Sweeps, Gauss-Newton steps, sweeps, none of which folds a triangle; a map that folds is left as it is. `before`: its
   value. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRelaxationRun(EqmSharedRelaxation relaxation, const EqmCascadeOptions *options,
                                                   EqmLevelValue *before);

#endif
