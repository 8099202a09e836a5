/* One attempt of several at the same map: its result kept beside the solver's, and the better one taken. */
#ifndef EQM_ATTEMPT_H
#define EQM_ATTEMPT_H

#include "solver/solver_private.h"

/* What one attempt has found. */
typedef struct {
  EqmIterate iterate;
  EqmHistoryRow *history;
  PetscReal *objectives;
  PetscInt num_history, max_history;
  EqmStatus status;
  char message[EQM_MESSAGE_MAX];
  const EqmStartType *start;
} EqmAttempt;

/* The attempts of a run so far. */
typedef struct {
  EqmSolverSettings first; /* the settings of the run */
  size_t suffix;           /* of the first attempt's checkpoint */
  PetscInt count;
} EqmAttempts;

/* The solver's map, history and outcome for the attempt's, and back. Collective. */
PETSC_INTERN PetscErrorCode EqmAttemptExchange(EqmSolver solver, EqmAttempt *attempt);
PETSC_INTERN PetscErrorCode EqmAttemptDestroy(EqmAttempt *attempt);
/* The attempt's end stays the solver's map, or, unless the run has been stopped, what was `before` if that is the
   better one: fewer folds, or as many and a lower objective, without terms a lower E per area. `ended`: there is an
   end. Collective. */
PETSC_INTERN PetscErrorCode EqmAttemptTakeBetter(EqmSolver solver, PetscBool ended, EqmAttempt *before);
/* The names of checkpoints, for the next attempt; and those of the first again. Collective. */
PETSC_INTERN PetscErrorCode EqmAttemptsNext(EqmSolver solver, EqmAttempts *attempts);
PETSC_INTERN PetscErrorCode EqmAttemptsEnd(EqmSolver solver, EqmAttempts *attempts);
/* Begin the next attempt from the present map, which `before` keeps with all that belongs to it: history and number of
   iterations go on. With -restart, the map that its checkpoint has. Collective. */
PETSC_INTERN PetscErrorCode EqmAttemptContinue(EqmSolver solver, EqmAttempts *attempts, EqmAttempt *before);

/* ---- balance.c */
/* Without -balance, the weight that -balance_energy begins with. Before the terms are made. Not collective. */
PETSC_INTERN PetscErrorCode EqmBalanceBegin(EqmSolver solver);
/* With -balance_energy: smaller weights of the angle energy, until E is low enough. Collective. */
PETSC_INTERN PetscErrorCode EqmBalanceLower(EqmSolver solver, EqmAttempts *attempts);

#endif
