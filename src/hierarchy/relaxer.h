/* Relaxation of maps of the mesh, again and again, on either kind of hierarchy. */
#ifndef EQM_RELAXER_H
#define EQM_RELAXER_H

#include "hierarchy/cascade.h"
#include "hierarchy/shared.h"

typedef struct _p_EqmRelaxer *EqmRelaxer;
/* On one of them, the other is NULL. Collective. */
PETSC_INTERN PetscErrorCode EqmRelaxerCreate(EqmHierarchy hierarchy, EqmShared shared, EqmCascadeTarget target,
                                             EqmRelaxer *relaxer);
PETSC_INTERN PetscErrorCode EqmRelaxerDestroy(EqmRelaxer *relaxer);
/* On shared levels multigrid's prolongations are at this map from now on, until the next call. Collective. */
PETSC_INTERN PetscErrorCode EqmRelaxerSetImage(EqmRelaxer relaxer, const EqmCascadeOptions *options,
                                               const PetscReal *x);
/* Relax a map as the cascade does it with its last: options->sweeps and steps; x: per vertex of the mesh that this rank
   owns. What folds is left as it is. Collective. */
PETSC_INTERN PetscErrorCode EqmRelaxerRun(EqmRelaxer relaxer, const EqmCascadeOptions *options, PetscReal *x,
                                          EqmCascadeResult *result);

#endif
