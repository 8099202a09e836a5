/* Linear systems with the pattern of a level: up to two unknowns per vertex, filled cell by cell, factored or solved by
   conjugate gradients with multigrid. */
#ifndef EQM_LEVELSYSTEM_H
#define EQM_LEVELSYSTEM_H

#include "hierarchy/level.h"
#include "hierarchy/prolongation.h"

typedef struct {
  const EqmHierarchyLevel *level;
  unsigned char *count;        /* unknowns per vertex */
  EqmBlockMatrix matrix;       /* columns ascending */
  PetscReal *right, *solution; /* two per vertex; zero in the place of unknowns that are not there */
  int *offset;                 /* 9 per cell: where in the row of corner a the column of corner b is, at 3 a + b */
  EqmLevelPieces cells;        /* those of different pieces have no row in common */
  EqmBlockFactor factor;       /* its analysis serves all matrices; empty before the first */
} EqmLevelSystem;

/* `count` unknowns per vertex. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemCreate(const EqmHierarchyLevel *level, const unsigned char *count,
                                                 EqmLevelSystem *system);
PETSC_INTERN PetscErrorCode EqmLevelSystemDestroy(EqmLevelSystem *system);
/* Zero matrix and right-hand side. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemClear(EqmLevelSystem *system);
/* Add a cell's matrix and vector, over the unknowns of its corners one after the other. Not collective. */
PETSC_INTERN void EqmLevelSystemAdd(EqmLevelSystem *system, PetscInt cell, const PetscReal *matrix,
                                    const PetscReal *right);
/* The block of a cell's corners a and b. */
static inline EqmBlock *EqmLevelSystemBlock(const EqmLevelSystem *system, PetscInt cell, PetscInt a, PetscInt b)
{
  return system->matrix.entry + system->matrix.start[system->level->cells[3 * cell + a]] +
         system->offset[9 * cell + 3 * a + b];
}

/* All cells are added: enlarge the diagonal by a factor of 1 + shift. `success` is false where the matrix cannot be
   positive definite. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemEnd(EqmLevelSystem *system, PetscReal shift, PetscBool *success);
/* Factor, for some thousand unknowns, and solve; `success` is false where the matrix is not positive definite. Not
   collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemFactorSolve(EqmLevelSystem *system, PetscBool *success);
/* Conjugate gradients with one V-cycle as preconditioner, until the error is down to `tolerance` of what it was (energy
   norm). `prolongation`: from each coarser level to the next finer one, the finest first. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemMultigridSolve(EqmLevelSystem *system, PetscInt num_prolongations,
                                                         const EqmProlongation *prolongation, PetscReal tolerance,
                                                         PetscInt *iterations, PetscBool *success);

#endif
