/* Choose and load the checkpoint that a run continues from. */
#include "solver/solver_private.h"
#include "solver/inner.h"
#include "base/lookup.h"
#include "base/quiet.h"

PetscErrorCode EqmSolverSetStage(EqmSolver solver, PetscInt stage)
{
  EqmSolverSettings *const set = &solver->settings;
  char number[32], previous[PETSC_MAX_PATH_LEN];
  PetscBool there, before;
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(number, sizeof(number), ".%" PetscInt_FMT, stage));
  PetscCall(PetscStrlen(number, &length));
  solver->checkpoints.suffix += length;
  if (set->checkpoint[0]) PetscCall(PetscStrlcat(set->checkpoint, number, sizeof(set->checkpoint)));
  if (!set->restart[0]) PetscFunctionReturn(0);
  PetscCall(PetscStrlcat(set->restart, number, sizeof(set->restart)));
  PetscCall(EqmStatePreviousName(set->restart, previous, sizeof(previous)));
  PetscCall(EqmFileIsThere(solver->comm, set->restart, &there));
  PetscCall(EqmFileIsThere(solver->comm, previous, &before));
  if (stage > 1 && !there && !before) set->restart[0] = '\0'; /* the run was stopped before */
  PetscFunctionReturn(0);
}

/* Open the newest of the two checkpoints that is not damaged. */
static PetscErrorCode OpenNewest(EqmSolver solver, char *name, size_t length)
{
  const char *const file = solver->settings.restart;
  PetscBool any = PETSC_FALSE, exists;
  char message[EQM_MESSAGE_MAX];
  PetscErrorCode error;

  PetscFunctionBegin;
  for (int k = 0; k < 2; k++) {
    PetscCall(PetscStrncpy(name, file, length));
    if (k == 1) PetscCall(EqmStatePreviousName(file, name, length));
    PetscCall(EqmFileIsThere(solver->comm, name, &exists));
    if (!exists) continue;
    any = PETSC_TRUE;
    PetscCall(PetscStrncpy(message, "no reason given", sizeof(message)));
    PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
    error = EqmStateOpen(solver->mesh, name, &solver->checkpoints.open);
    PetscCall(PetscPopErrorHandler());
    if (!error) PetscFunctionReturn(0);
    PetscCall(EqmWarn(solver->comm, message, "; it is left out"));
  }
  if (!any) EqmFail(solver->comm, EQM_ERR_IO, "-restart %s: there is no such file", file);
  EqmFail(solver->comm, EQM_ERR_CHECKPOINT, "-restart %s: there is no sound checkpoint; begin anew, without -restart",
          file);
}

PetscErrorCode EqmCheckpointLoadMap(EqmSolver solver)
{
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(OpenNewest(solver, name, sizeof(name)));
  PetscCall(EqmCheckpointVisitMap(solver->checkpoints.open, solver));
  solver->checkpoints.resumed = solver->iterate->number;
  if (!solver->checkpoints.finished) solver->message[0] = '\0';
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  PetscCall(EqmProblemNotify(solver->problem, "restart from '%s', after iteration %" PetscInt_FMT "\n", name,
                             solver->iterate->number));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckpointLoadMethod(EqmSolver solver)
{
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(EqmCheckpointVisitMethod(solver->checkpoints.open, solver));
  PetscCall(EqmStateClose(&solver->checkpoints.open));
  PetscCall(PetscStrcmp(solver->settings.checkpoint, solver->settings.restart, &same));
  if (same) solver->checkpoints.written = solver->iterate->number;
  PetscFunctionReturn(0);
}
