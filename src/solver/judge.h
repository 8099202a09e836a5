/* Convergence tests, and the status and message of a run. */
#ifndef EQM_JUDGE_H
#define EQM_JUDGE_H

#include "solver/solver_private.h"

/* Does a stopping criterion hold after this iteration? Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeIteration(EqmSolver solver, PetscBool *stop);
/* Set status and message when the method has no further step; the method's own message, if any, is used. Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeEnd(EqmSolver solver, EqmStep outcome);
/* Above this energy per measure of the image a map is poor; 0: none is. Of surfaces ratios off by a
   tenth, root mean square: almost all have a map of equal areas. Elsewhere, where other things are wanted or equal
   ratios cannot be had, the objective's. Not collective. */
PETSC_INTERN PetscReal EqmJudgePoorEnergy(EqmSolver solver);
/* A map that has not converged and is of no use says so. Collective. */
PETSC_INTERN PetscErrorCode EqmJudgePoor(EqmSolver solver);
/* A map with folds is no success, wherever they are. Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeFolds(EqmSolver solver);

#endif
