/* Linear systems on shared levels: conjugate gradients with multigrid on all levels below, by PETSc. */
#ifndef EQM_SHAREDSOLVE_H
#define EQM_SHAREDSOLVE_H

#include "hierarchy/levelsystem.h"
#include "hierarchy/sharedmap.h"
#include "hierarchy/sharedrows.h"

/* Prolongations from each coarser level to the next finer one, the finest first: two rows per vertex that a rank owns,
   two columns per coarse one. Levels of the hierarchy that goes on below are the first rank's. */
typedef struct {
  PetscInt num;
  EqmSharedRows rows[2 * EQM_MOST_LEVELS];
  PetscInt num_coarse[2 * EQM_MOST_LEVELS]; /* coarse vertices that this rank owns */
  Mat matrix[2 * EQM_MOST_LEVELS];          /* the same as `rows` */
} EqmSharedProlongations;

/* At a map of level k of the shared ones, down to a level of no more than `direct` vertices. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedProlongationsCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target,
                                                         const EqmLevelMap *map, PetscInt direct,
                                                         EqmSharedProlongations *prolongations);
PETSC_INTERN PetscErrorCode EqmSharedProlongationsDestroy(EqmSharedProlongations *prolongations);

/* Solve the system of a level, of which each rank has its vertices' rows, until the error is down to `tolerance` of
   what it was (energy norm); the solution has its ghosts' entries, too. `success` is false where the matrix is not
   positive definite. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedSolve(const EqmSharedLevel *shared, EqmLevelSystem *system,
                                           const EqmSharedProlongations *prolongations, PetscReal tolerance,
                                           PetscInt *iterations, PetscBool *success);

#endif
