/* Multigrid on the levels of a hierarchy: Galerkin products, one sweep before and its transpose after, so that a cycle
   is a symmetric operator; conjugate gradients by PETSc. */
#ifndef EQM_CYCLE_H
#define EQM_CYCLE_H

#include "hierarchy/levelsystem.h"
#include "hierarchy/sweeps.h"

enum { EQM_CYCLE_BOTTOM = 500 }; /* vertices of a level small enough to be factored again and again */
typedef struct _p_EqmCycle *EqmCycle;
/* Patterns of all levels. `prolongation`: from each coarser level to the next finer one, the finest first; they and
   `finest` must outlive the cycle. Not collective. */
PETSC_INTERN PetscErrorCode EqmCycleCreate(const EqmBlockMatrix *finest, PetscInt num_prolongations,
                                           const EqmProlongation *prolongation, EqmCycle *cycle);
/* Matrices of all levels from the present entries of the finest one, whose diagonal is complete, and the coarsest one's
   factor. `success` is false where one is not positive definite; the cycle must then be filled again before it solves.
   Not collective. */
PETSC_INTERN PetscErrorCode EqmCycleFill(EqmCycle cycle, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmCycleDestroy(EqmCycle *cycle);
/* One cycle from zero. Not collective. */
PETSC_INTERN PetscErrorCode EqmCycleApply(EqmCycle cycle, const PetscReal *b, PetscReal *x);
/* EqmConjugateGradients with one cycle as preconditioner. Not collective. */
PETSC_INTERN PetscErrorCode EqmCycleSolve(EqmCycle cycle, PetscReal *b, PetscReal *x, PetscReal tolerance,
                                          PetscInt *iterations, PetscBool *success);

#endif
