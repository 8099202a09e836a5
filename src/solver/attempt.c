/* Keeping one attempt beside another: see attempt.h. */
#include "solver/attempt.h"
#include "solver/inner.h"

#define SWAP(type, a, b)                                                                                               \
  do {                                                                                                                 \
    type kept = (a);                                                                                                   \
    (a) = (b);                                                                                                         \
    (b) = kept;                                                                                                        \
  } while (0)

PetscErrorCode EqmAttemptExchange(EqmSolver solver, EqmAttempt *attempt)
{
  char message[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  SWAP(EqmIterate, solver->iterate, attempt->iterate);
  SWAP(EqmHistoryRow *, solver->history, attempt->history);
  SWAP(PetscReal *, solver->objectives, attempt->objectives);
  SWAP(PetscInt, solver->num_history, attempt->num_history);
  SWAP(PetscInt, solver->max_history, attempt->max_history);
  SWAP(EqmStatus, solver->status, attempt->status);
  SWAP(const EqmStartType *, solver->start, attempt->start);
  PetscCall(PetscStrncpy(message, solver->message, sizeof(message)));
  PetscCall(PetscStrncpy(solver->message, attempt->message, sizeof(solver->message)));
  PetscCall(PetscStrncpy(attempt->message, message, sizeof(attempt->message)));
  solver->rows_shown = 0;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAttemptDestroy(EqmAttempt *attempt)
{
  PetscFunctionBegin;
  PetscCall(EqmIterateDestroy(&attempt->iterate));
  PetscCall(PetscFree(attempt->history));
  PetscCall(PetscFree(attempt->objectives));
  PetscFunctionReturn(0);
}

/* E and the terms; without them E per area of the image, which is how far ratios are off: a map of few boundary
   vertices has less E where its image is small. */
static PetscErrorCode Evaluate(EqmProblem problem, EqmIterate iterate, PetscReal *value)
{
  PetscReal *image;

  PetscFunctionBegin;
  *value = problem->terms ? iterate->totals.energy : EqmIterateMeanEnergy(iterate);
  if (!problem->terms) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &image));
  PetscCall(EqmProblemEvaluate(problem, iterate, &iterate->place, image, value, NULL));
  PetscCall(PetscFree(image));
  PetscFunctionReturn(0);
}

static PetscErrorCode IsBetter(EqmProblem problem, EqmIterate a, EqmIterate b, PetscBool *better)
{
  PetscReal of_a, of_b;

  PetscFunctionBegin;
  PetscCall(Evaluate(problem, a, &of_a));
  PetscCall(Evaluate(problem, b, &of_b));
  *better = (PetscBool)(a->totals.folds == b->totals.folds ? of_a < of_b : a->totals.folds < b->totals.folds);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAttemptTakeBetter(EqmSolver solver, PetscBool ended, EqmAttempt *before)
{
  PetscBool better = ended;

  PetscFunctionBegin;
  if (ended && solver->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (ended) PetscCall(IsBetter(solver->problem, solver->iterate, before->iterate, &better));
  if (!better) PetscCall(EqmAttemptExchange(solver, before));
  PetscFunctionReturn(0);
}

/* ---- names of checkpoints */

static PetscErrorCode SetStage(EqmSolver solver, const EqmAttempts *attempts, PetscInt stage)
{
  EqmSolverSettings *const set = &solver->settings;
  EqmCheckpoints *const known = &solver->checkpoints;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(set->checkpoint, attempts->first.checkpoint, sizeof(set->checkpoint)));
  PetscCall(PetscStrncpy(set->restart, attempts->first.restart, sizeof(set->restart)));
  known->suffix = attempts->suffix;
  known->written = -1;
  known->resumed = 0;
  known->finished = PETSC_FALSE;
  if (stage > 1) PetscCall(EqmSolverSetStage(solver, stage));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAttemptsNext(EqmSolver solver, EqmAttempts *attempts)
{
  PetscFunctionBegin;
  PetscCall(SetStage(solver, attempts, ++attempts->count));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAttemptsEnd(EqmSolver solver, EqmAttempts *attempts)
{
  PetscFunctionBegin;
  if (attempts->count > 1) PetscCall(SetStage(solver, attempts, 1));
  PetscFunctionReturn(0);
}

/* ---- from the present map */

/* The map so far, its history and what the checkpoint of this attempt has in their place. */
static PetscErrorCode TakeOver(EqmSolver solver, const EqmAttempt *from)
{
  EqmIterate const iterate = solver->iterate;

  PetscFunctionBegin;
  solver->limited = PETSC_FALSE;
  if (solver->settings.restart[0]) {
    PetscCall(EqmCheckpointLoadMap(solver));
  } else {
    PetscCall(EqmPlaceCopy(solver->problem->domain, &from->iterate->place, &iterate->place));
    iterate->number = from->iterate->number + 1;
    PetscCall(EqmHistoryReserve(solver, from->num_history));
    PetscCall(PetscArraycpy(solver->history, from->history, from->num_history));
    PetscCall(PetscArraycpy(solver->objectives, from->objectives, from->num_history));
    solver->begun_again = solver->num_history = from->num_history;
  }
  PetscCall(EqmIterateUpdate(solver->problem, iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmAttemptContinue(EqmSolver solver, EqmAttempts *attempts, EqmAttempt *before)
{
  PetscFunctionBegin;
  *before = (EqmAttempt){.status = EQM_STATUS_NOT_CONVERGED, .start = solver->start};
  PetscCall(EqmAttemptsNext(solver, attempts));
  PetscCall(EqmIterateCreate(solver->problem, &before->iterate));
  PetscCall(EqmAttemptExchange(solver, before));
  PetscCall(TakeOver(solver, before));
  PetscFunctionReturn(0);
}
