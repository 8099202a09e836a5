/* Linear systems on shared levels: conjugate gradients with multigrid on all levels below, by PETSc. */
#ifndef EQM_SHAREDSOLVE_H
#define EQM_SHAREDSOLVE_H

#include "hierarchy/levelsystem.h"
#include "hierarchy/sharedmap.h"

/* Prolongations from each coarser level to the next finer one, the finest first: two rows per vertex that a rank owns,
   two columns per coarse one. Levels of the hierarchy that goes on below are the first rank's. */
typedef struct {
  PetscInt num;
  Mat matrix[2 * EQM_MOST_LEVELS];
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

/* A matrix of two rows per block row and two columns per block column, of which this rank has num_rows and num_columns;
   blocks of row i are start[i] .. start[i + 1] - 1, columns numbered over all ranks; -1: none. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedMatrix(MPI_Comm comm, PetscInt num_rows, PetscInt num_columns,
                                            const PetscInt *start, const PetscInt *column, const EqmBlock *entry,
                                            Mat *matrix);

#endif
