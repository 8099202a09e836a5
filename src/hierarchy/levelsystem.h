/* Linear systems with the pattern of a level: a few unknowns per vertex, filled cell by cell, factored or solved by
   conjugate gradients with multigrid. */
#ifndef EQM_LEVELSYSTEM_H
#define EQM_LEVELSYSTEM_H

#include <petscksp.h>
#include "hierarchy/hierarchy.h"

typedef struct {
  const EqmHierarchyLevel *level;
  PetscInt num_unknowns, *first; /* per vertex, and one more: its first unknown */
  PetscInt *row, *column;        /* the matrix's pattern, columns ascending */
  PetscReal *entry, *right;
  int *offset; /* 9 per cell: where in the rows of corner a the columns of corner b begin, at 3 a + b */
  Mat matrix;  /* of these arrays */
  Vec solution;
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
/* Enlarge the diagonal by a factor of 1 + shift. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemShift(EqmLevelSystem *system, PetscReal shift);
/* Factor by PETSc's own Cholesky, for some thousand unknowns, and solve; `success` is false where the matrix is not
   positive definite. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemFactorSolve(EqmLevelSystem *system, PetscBool *success);
/* Conjugate gradients with one V-cycle as preconditioner, until the error is down to `tolerance` of what it was (energy
   norm). `prolongation`: from each coarser level to the next finer one, the finest first. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelSystemMultigridSolve(EqmLevelSystem *system, PetscInt num_prolongations,
                                                         const Mat *prolongation, PetscReal tolerance,
                                                         PetscInt *iterations, PetscBool *success);

#endif
