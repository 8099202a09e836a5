/* When a run ends, and what it is worth: status and message. */
#ifndef EQM_JUDGE_H
#define EQM_JUDGE_H

#include "solver/solver_private.h"

/* Is there reason to stop after this iteration? Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeIteration(EqmSolver solver, PetscBool *stop);
/* The method has no further step; its message says why, if there is something to say. Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeEnd(EqmSolver solver, EqmStep outcome);
/* A map with folds is no success, wherever they are. Collective. */
PETSC_INTERN PetscErrorCode EqmJudgeFolds(EqmSolver solver);

#endif
