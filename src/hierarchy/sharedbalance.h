#ifndef EQM_SHAREDBALANCE_H
#define EQM_SHAREDBALANCE_H

#include "hierarchy/balance.h"
#include "hierarchy/sharedcycle.h"

/* As EqmBalanceLevel, for a map of shared level k, with multigrid on all levels below it down to `direct` vertices;
   `iterations` of all steps together. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedBalance(EqmShared shared, PetscInt k, EqmCascadeTarget target, PetscInt direct,
                                             const EqmBalanceOptions *options, EqmLevelMap *map, PetscInt *iterations);

#endif
