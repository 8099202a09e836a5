/* Multigrid on shared levels and those of the first rank below them: as EqmCycle, but that ranks sweep their own rows,
   piece by piece, which makes the same smoother on any number of them. */
#ifndef EQM_SHAREDCYCLE_H
#define EQM_SHAREDCYCLE_H

#include "hierarchy/levelsystem.h"
#include "hierarchy/sharedmap.h"

typedef struct _p_EqmSharedCycle *EqmSharedCycle;
/* Prolongations at a map of level k, which is not the last shared one, down to a level of no more than `most`
   vertices, and patterns of all levels; the system is the map's and must outlive the cycle. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedCycleCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target,
                                                 const EqmLevelMap *map, PetscInt most, EqmLevelSystem *system,
                                                 EqmSharedCycle *cycle);
PETSC_INTERN PetscErrorCode EqmSharedCycleDestroy(EqmSharedCycle *cycle);
/* Matrices of all levels from the system's present entries, of which each rank has its vertices' rows. `success` is
   false where one is not positive definite; the cycle must then be filled again before it solves. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedCycleFill(EqmSharedCycle cycle, PetscBool *success);
/* EqmConjugateGradients for the system, with one cycle as preconditioner; the solution has its ghosts' entries, too.
   Collective. */
PETSC_INTERN PetscErrorCode EqmSharedCycleSolve(EqmSharedCycle cycle, PetscReal tolerance, PetscInt *iterations,
                                                PetscBool *success);

#endif
