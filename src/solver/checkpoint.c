/* When a checkpoint is written, and when a run stops on request. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include "base/atomicfile.h"
#include "base/lookup.h"
#include "base/quiet.h"
#include "store/keptmesh.h"
#include <libgen.h>

PetscErrorCode EqmCheckpointBegin(EqmSolver solver)
{
  const char *const file = solver->settings.checkpoint;
  char copy[PETSC_MAX_PATH_LEN];
  PetscBool kept;

  PetscFunctionBegin;
  solver->checkpoints.written = -1;
  if (!file[0]) PetscFunctionReturn(0);
  PetscCall(EqmLockTake(solver->comm, file, "-checkpoint", &solver->checkpoints.lock));
  if (solver->mesh->rank == 0) EqmAtomicSweep(file);
  if (!solver->checkpoints.stop_file.name[0])
    PetscCall(EqmStopWatchFile(solver->comm, file, &solver->checkpoints.stop_file));
  if (solver->checkpoints.kept_mesh[0]) PetscFunctionReturn(0);
  PetscCall(EqmKeptMeshName(file, NULL, copy, sizeof(copy)));
  PetscCall(EqmFileIsThere(solver->comm, copy, &kept));
  if (kept) PetscCall(PetscStrncpy(solver->checkpoints.kept_mesh, basename(copy), sizeof(copy)));
  PetscFunctionReturn(0);
}

/* Record whether writing succeeded; the first failure is reported. */
static PetscErrorCode RecordOutcome(EqmSolver solver, PetscErrorCode error, const char *message)
{
  EqmCheckpoints *const known = &solver->checkpoints;

  PetscFunctionBegin;
  if (error && !known->failing)
    PetscCall(EqmWarn(solver->comm, message, "; the run goes on, and what was written before is still there"));
  known->failing = (PetscBool)(error != 0);
  if (error) known->written = -1;
  PetscFunctionReturn(0);
}

/* Wait until the last checkpoint is on disk. */
static PetscErrorCode Finish(EqmSolver solver)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  if (!solver->checkpoints.writing) PetscFunctionReturn(0);
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStateFinish(&solver->checkpoints.writing);
  PetscCall(PetscPopErrorHandler());
  PetscCall(RecordOutcome(solver, error, message));
  PetscFunctionReturn(0);
}

/* Begin to write a checkpoint; the disk may still be busy when the next iteration begins. */
static PetscErrorCode Save(EqmSolver solver)
{
  EqmCheckpoints *const known = &solver->checkpoints;
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(Finish(solver));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStateSave(solver->mesh, solver->settings.checkpoint, EqmCheckpointVisit, solver, &known->writing);
  PetscCall(PetscPopErrorHandler());
  known->written = solver->iterate->number;
  if (error) PetscCall(RecordOutcome(solver, error, message));
  PetscFunctionReturn(0);
}

/* Begin to write a checkpoint, finish the last one, or both; the time counts as checkpoint time. */
static PetscErrorCode Write(EqmSolver solver, PetscBool save, PetscBool finish)
{
  EqmCheckpoints *const known = &solver->checkpoints;
  const EqmLedger ledger = solver->mesh->ledger;
  PetscReal before, after;

  PetscFunctionBegin;
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_MINIMISE));
  PetscCall(EqmLedgerGetSeconds(ledger, NULL, NULL, &before));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_CHECKPOINT));
  if (save) PetscCall(Save(solver));
  if (finish) PetscCall(Finish(solver));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_CHECKPOINT));
  PetscCall(EqmLedgerGetSeconds(ledger, NULL, NULL, &after));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_MINIMISE));
  known->cost = after - before;
  known->last = after;
  PetscFunctionReturn(0);
}

/* Is a checkpoint due: after -checkpoint_every iterations, or without that option when checkpoints take no more than a
   small part of the run time? */
static PetscBool IsDue(EqmSolver solver)
{
  const EqmCheckpoints *const known = &solver->checkpoints;
  const PetscInt every = solver->settings.checkpoint_every;
  const PetscReal share = .03, now = solver->history[solver->num_history - 1].seconds;

  if (!solver->settings.checkpoint[0] || every == 0 || solver->iterate->number == known->written) return PETSC_FALSE;
  if (every > 0) return (PetscBool)(solver->iterate->number % every == 0);
  return (PetscBool)(now - known->last >= known->cost / share);
}

PetscErrorCode EqmCheckpointIfDue(EqmSolver solver)
{
  PetscFunctionBegin;
  if (IsDue(solver)) PetscCall(Write(solver, PETSC_TRUE, PETSC_FALSE));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckpointEnd(EqmSolver solver)
{
  EqmCheckpoints *const known = &solver->checkpoints;

  PetscFunctionBegin;
  if (!solver->settings.checkpoint[0]) PetscFunctionReturn(0);
  PetscCall(Write(solver, (PetscBool)(solver->iterate->number != known->written || known->finished), PETSC_TRUE));
  if (!known->failing) PetscFunctionReturn(0);
  if (solver->status != EQM_STATUS_STOPPED) {
    PetscCall(PetscStrlcat(solver->message, "; the last checkpoint could not be written", sizeof(solver->message)));
    PetscFunctionReturn(0);
  }
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                          "stopped on request, but no checkpoint could be written: this is the map so far"));
  PetscFunctionReturn(0);
}

/* ---- stopping */

/* Seconds to reserve so that one more iteration and a checkpoint end before -wall_time. Every run makes at least one
   iteration, as otherwise a chain of restarts would not progress. */
static PetscReal ReservedSeconds(EqmSolver solver)
{
  const EqmHistoryRow *const last = &solver->history[solver->num_history - 1];

  if (!solver->settings.checkpoint[0] || solver->iterate->number <= solver->checkpoints.resumed) return 0.;
  return last->seconds - last[-1].seconds + solver->checkpoints.cost;
}

PetscErrorCode EqmCheckpointStopRequested(EqmSolver solver, PetscBool *stop)
{
  const EqmSolverSettings *const set = &solver->settings;
  EqmStopReason reason;
  PetscReal seconds, earlier;
  size_t length;

  PetscFunctionBegin;
  *stop = PETSC_FALSE;
  if (solver->checkpoints.ignores_requests) PetscFunctionReturn(0);
  PetscCall(EqmStopRequested(solver->comm, &solver->checkpoints.stop_file, &reason));
  PetscCall(EqmLedgerGetSeconds(solver->mesh->ledger, NULL, NULL, &seconds));
  PetscCall(EqmLedgerGetEarlier(solver->mesh->ledger, &earlier));
  seconds -= earlier;
  *stop = PETSC_TRUE;
  if (reason != EQM_STOP_NONE) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "stopped by %s after iteration %" PetscInt_FMT,
                            EqmStopReasonName(reason), solver->iterate->number));
  } else if (set->wall_time > 0. && seconds + ReservedSeconds(solver) >= set->wall_time) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "stopped by -wall_time %.6g s",
                            (double)set->wall_time));
  } else {
    *stop = PETSC_FALSE;
    PetscFunctionReturn(0);
  }
  solver->status = EQM_STATUS_NOT_CONVERGED;
  if (!set->checkpoint[0]) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_STOPPED;
  PetscCall(PetscStrlcat(solver->message, "; to go on: the same command with -restart ", sizeof(solver->message)));
  PetscCall(PetscStrlcat(solver->message, set->checkpoint, sizeof(solver->message)));
  PetscCall(PetscStrlen(solver->message, &length));
  solver->message[length - solver->checkpoints.suffix] = '\0';
  PetscFunctionReturn(0);
}
