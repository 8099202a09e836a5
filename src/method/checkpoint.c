/* What a checkpoint holds, and when one is written. */
#include "method/method.h"
#include "base/atomicfile.h"
#include "base/quiet.h"
#include "store/keptmesh.h"
#include <libgen.h>
#include <unistd.h>

enum { HISTORY_COLUMNS = 10 };

/* ---- what it holds */

static void PackRow(const EqmHistoryRow *row, PetscReal objective, PetscReal *packed)
{
  const PetscReal values[HISTORY_COLUMNS] = {row->energy,
                                             row->sd,
                                             (PetscReal)row->folds,
                                             row->step,
                                             row->gradient_norm,
                                             (PetscReal)row->work.evaluations,
                                             (PetscReal)row->work.factorizations,
                                             (PetscReal)row->work.coupled_factorizations,
                                             (PetscReal)row->work.solves,
                                             row->seconds};

  for (PetscInt k = 0; k < HISTORY_COLUMNS; k++) packed[k] = values[k];
  packed[HISTORY_COLUMNS] = objective;
}

static EqmHistoryRow UnpackRow(PetscInt iteration, const PetscReal *packed)
{
  return (EqmHistoryRow){.iteration = iteration,
                         .energy = packed[0],
                         .sd = packed[1],
                         .folds = (PetscInt64)packed[2],
                         .step = packed[3],
                         .gradient_norm = packed[4],
                         .work = {(PetscInt64)packed[5], (PetscInt64)packed[6], (PetscInt64)packed[7],
                                  (PetscInt64)packed[8]},
                         .seconds = packed[9]};
}

/* Row after row, the objective last; the columns are told in an attribute. */
static PetscErrorCode VisitHistory(EqmState state, EqmSolver solver)
{
  char columns[] = "energy, sd, folds, step, gradient_norm, evaluations, factorizations, coupled_factorizations, "
                   "solves, seconds, objective";
  PetscReal *packed;
  PetscInt rows = solver->num_history;

  PetscFunctionBegin;
  PetscCall(EqmStateText(state, "history_columns", columns, sizeof(columns)));
  PetscCall(EqmStateInt(state, "num_history", &rows));
  PetscCall(PetscMalloc1((HISTORY_COLUMNS + 1) * rows, &packed));
  for (PetscInt k = 0; k < solver->num_history; k++)
    PackRow(&solver->history[k], solver->objectives[k], packed + (HISTORY_COLUMNS + 1) * k);
  PetscCall(EqmStateReals(state, "history", (HISTORY_COLUMNS + 1) * rows, packed));
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmMonitorReserve(solver, rows));
    for (PetscInt k = 0; k < rows; k++) {
      solver->history[k] = UnpackRow(k, packed + (HISTORY_COLUMNS + 1) * k);
      solver->objectives[k] = packed[(HISTORY_COLUMNS + 1) * k + HISTORY_COLUMNS];
    }
    solver->num_history = rows;
  }
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(0);
}

/* A run of another problem must not go on from here. */
static PetscErrorCode VisitProblem(EqmState state, EqmSolver solver)
{
  const EqmSettings *const set = &solver->settings;
  char corners[128] = "";

  PetscFunctionBegin;
  if (set->has_corners) {
    PetscCall(PetscSNPrintf(corners, sizeof(corners),
                            "%" PetscInt_FMT ",%" PetscInt_FMT ",%" PetscInt_FMT ",%" PetscInt_FMT, set->corners[0],
                            set->corners[1], set->corners[2], set->corners[3]));
  }
  PetscCall(EqmStateGroup(state, ""));
  PetscCall(EqmStateSameInt(state, "the checksum of mesh and density", solver->mesh->identity));
  PetscCall(EqmStateSameText(state, "command", solver->target));
  PetscCall(EqmStateSameText(state, "method", solver->method->name));
  PetscCall(EqmStateSameReal(state, "-balance", PetscMax(set->balance, 0.)));
  PetscCall(EqmStateSameText(state, "-corners", corners));
  PetscCall(EqmStateSameInt(state, "the number of landmarks", solver->landmarks.num_total));
  PetscCall(EqmStateSameReal(state, "the landmarks' weight", solver->landmarks.lambda));
  PetscFunctionReturn(0);
}

/* Clocks go on from where they stood. */
static PetscErrorCode VisitSeconds(EqmState state, EqmSolver solver)
{
  PetscReal phases[EQM_NUM_PHASES], events[EQM_NUM_EVENTS], total;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetSeconds(solver->mesh->ledger, phases, events, &total));
  PetscCall(EqmStateReal(state, "seconds", &total));
  PetscCall(EqmStateReals(state, "phase_seconds", EQM_NUM_PHASES, phases));
  PetscCall(EqmStateReals(state, "event_seconds", EQM_NUM_EVENTS, events));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  PetscCall(EqmLedgerContinue(solver->mesh->ledger, phases, events, total));
  PetscFunctionReturn(0);
}

/* The copy of the mesh that a run left beside its checkpoint, for whoever goes on without the mesh itself. */
static PetscErrorCode VisitKeptMesh(EqmState state, EqmSolver solver)
{
  char copy[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(copy, solver->checkpoints.kept_mesh, sizeof(copy)));
  PetscCall(EqmStateText(state, EQM_KEPT_MESH, copy, sizeof(copy)));
  PetscFunctionReturn(0);
}

/* All that can be known before the method is set up. */
static PetscErrorCode VisitMap(EqmState state, EqmSolver solver)
{
  PetscInt status = (PetscInt)solver->status;

  PetscFunctionBegin;
  PetscCall(VisitProblem(state, solver));
  PetscCall(VisitKeptMesh(state, solver));
  PetscCall(EqmStatePlace(state, solver->domain, "map", &solver->place));
  PetscCall(EqmStateGroup(state, "solver"));
  PetscCall(EqmStateInt(state, "iteration", &solver->iteration));
  PetscCall(EqmStateInt64(state, "unfolded_from", &solver->unfolded_from));
  PetscCall(EqmStateInt64(state, "unfolded_to", &solver->unfolded_to));
  PetscCall(EqmStateBool(state, "finished", &solver->checkpoints.finished));
  PetscCall(EqmStateInt(state, "status", &status));
  PetscCall(EqmStateText(state, "message", solver->message, sizeof(solver->message)));
  solver->status = (EqmStatus)status;
  PetscCall(VisitHistory(state, solver));
  PetscCall(VisitSeconds(state, solver));
  PetscFunctionReturn(0);
}

/* The rest; what set_up has done to the map, and the state of the method to figures and counters, is set right. */
static PetscErrorCode VisitMethod(EqmState state, EqmSolver solver)
{
  EqmWork *work;

  PetscFunctionBegin;
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmStateGroup(state, ""));
    PetscCall(EqmStatePlace(state, solver->domain, "map", &solver->place));
    PetscCall(EqmSolverLook(solver));
  }
  PetscCall(EqmStateGroup(state, solver->method->name));
  if (solver->method->state) PetscCall(solver->method->state(solver, state));
  PetscCall(EqmStateGroup(state, "solver"));
  PetscCall(EqmStateReal(state, "objective", &solver->objective));
  PetscCall(EqmStateReal(state, "gradient_norm", &solver->gradient_norm));
  PetscCall(EqmStateReal(state, "step_length", &solver->step_length));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  PetscCall(EqmStateInt64(state, "evaluations", &work->evaluations));
  PetscCall(EqmStateInt64(state, "factorizations", &work->factorizations));
  PetscCall(EqmStateInt64(state, "coupled_factorizations", &work->coupled_factorizations));
  PetscCall(EqmStateInt64(state, "solves", &work->solves));
  PetscFunctionReturn(0);
}

static PetscErrorCode Visit(EqmState state, void *context)
{
  PetscFunctionBegin;
  PetscCall(VisitMap(state, context));
  PetscCall(VisitMethod(state, context));
  PetscFunctionReturn(0);
}

/* ---- saving */

static PetscErrorCode Exists(EqmSolver solver, const char *file, PetscBool *exists)
{
  PetscFunctionBegin;
  *exists = (PetscBool)(solver->mesh->rank == 0 && !access(file, F_OK));
  PetscCallMPI(MPI_Bcast(exists, 1, MPIU_BOOL, 0, solver->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckpointBegin(EqmSolver solver)
{
  const char *const file = solver->settings.checkpoint;
  char copy[PETSC_MAX_PATH_LEN];
  PetscBool kept;

  PetscFunctionBegin;
  solver->checkpoints.written = -1;
  if (!file[0]) PetscFunctionReturn(0);
  if (solver->mesh->rank == 0) EqmAtomicSweep(file);
  PetscCall(EqmStopWatchFile(solver->comm, file, &solver->checkpoints.stop_file));
  PetscCall(EqmKeptMeshName(file, copy, sizeof(copy)));
  PetscCall(Exists(solver, copy, &kept));
  if (kept) PetscCall(PetscStrncpy(solver->checkpoints.kept_mesh, basename(copy), sizeof(copy)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetStage(EqmSolver solver, PetscInt stage)
{
  EqmSettings *const set = &solver->settings;
  char number[32], previous[PETSC_MAX_PATH_LEN];
  PetscBool there, before;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(number, sizeof(number), ".%" PetscInt_FMT, stage));
  PetscCall(PetscStrlen(number, &solver->checkpoints.suffix));
  if (set->checkpoint[0]) PetscCall(PetscStrlcat(set->checkpoint, number, sizeof(set->checkpoint)));
  if (!set->restart[0]) PetscFunctionReturn(0);
  PetscCall(PetscStrlcat(set->restart, number, sizeof(set->restart)));
  PetscCall(EqmStatePreviousName(set->restart, previous, sizeof(previous)));
  PetscCall(Exists(solver, set->restart, &there));
  PetscCall(Exists(solver, previous, &before));
  if (stage > 1 && !there && !before) set->restart[0] = '\0'; /* the run had not come so far */
  PetscFunctionReturn(0);
}

/* How writing went; a failure is told the first time. */
static PetscErrorCode Note(EqmSolver solver, PetscErrorCode error, const char *message)
{
  EqmCheckpoints *const known = &solver->checkpoints;

  PetscFunctionBegin;
  if (error && !known->failing)
    PetscCall(EqmWarn(solver->comm, message, "; the run goes on, and what was written before is still there"));
  known->failing = (PetscBool)(error != 0);
  if (error) known->written = -1;
  PetscFunctionReturn(0);
}

/* Wait for the disk. */
static PetscErrorCode Finish(EqmSolver solver)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  if (!solver->checkpoints.writing) PetscFunctionReturn(0);
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStateFinish(&solver->checkpoints.writing);
  PetscCall(PetscPopErrorHandler());
  PetscCall(Note(solver, error, message));
  PetscFunctionReturn(0);
}

/* Write one while the disk may still be busy with it when the next iteration begins. */
static PetscErrorCode Save(EqmSolver solver)
{
  EqmCheckpoints *const known = &solver->checkpoints;
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(Finish(solver));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = EqmStateSave(solver->mesh, solver->settings.checkpoint, Visit, solver, &known->writing);
  PetscCall(PetscPopErrorHandler());
  known->written = solver->iteration;
  if (error) PetscCall(Note(solver, error, message));
  PetscFunctionReturn(0);
}

/* Write one now, or wait for the last one, or both, by the clock of checkpoints. */
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

/* Every so many iterations; or, if that is left open, when it costs no more than a small part of the time. */
static PetscBool IsDue(EqmSolver solver)
{
  const EqmCheckpoints *const known = &solver->checkpoints;
  const PetscInt every = solver->settings.checkpoint_every;
  const PetscReal share = .03, now = solver->history[solver->num_history - 1].seconds;

  if (!solver->settings.checkpoint[0] || every == 0 || solver->iteration == known->written) return PETSC_FALSE;
  if (every > 0) return (PetscBool)(solver->iteration % every == 0);
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
  PetscCall(Write(solver, (PetscBool)(solver->iteration != known->written || known->finished), PETSC_TRUE));
  if (solver->status != EQM_STATUS_STOPPED || !known->failing) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                          "stopped on request, but no checkpoint could be written: this is the map so far"));
  PetscFunctionReturn(0);
}

/* ---- loading */

/* The newer of the two checkpoints that is sound. */
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
    PetscCall(Exists(solver, name, &exists));
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
  PetscCall(VisitMap(solver->checkpoints.open, solver));
  solver->checkpoints.resumed = solver->iteration;
  if (!solver->checkpoints.finished) solver->message[0] = '\0';
  PetscCall(EqmSolverLook(solver));
  if (!solver->settings.quiet)
    PetscCall(
        PetscPrintf(solver->comm, "restart from '%s', after iteration %" PetscInt_FMT "\n", name, solver->iteration));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckpointLoadMethod(EqmSolver solver)
{
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(VisitMethod(solver->checkpoints.open, solver));
  PetscCall(EqmStateClose(&solver->checkpoints.open));
  PetscCall(PetscStrcmp(solver->settings.checkpoint, solver->settings.restart, &same));
  if (same) solver->checkpoints.written = solver->iteration;
  PetscFunctionReturn(0);
}

/* ---- stopping */

/* Seconds to keep in hand so that one more iteration and a checkpoint end before -wall_time. A run makes one iteration
   at least, or a chain of restarts would not move. */
static PetscReal Reserve(EqmSolver solver)
{
  const EqmHistoryRow *const last = &solver->history[solver->num_history - 1];

  if (!solver->settings.checkpoint[0] || solver->iteration <= solver->checkpoints.resumed) return 0.;
  return last->seconds - last[-1].seconds + solver->checkpoints.cost;
}

PetscErrorCode EqmCheckpointAskedToStop(EqmSolver solver, PetscBool *stop)
{
  const EqmSettings *const set = &solver->settings;
  EqmStopReason reason;
  PetscReal seconds, earlier;
  size_t length;

  PetscFunctionBegin;
  PetscCall(EqmStopRequested(solver->comm, &solver->checkpoints.stop_file, &reason));
  PetscCall(EqmLedgerGetSeconds(solver->mesh->ledger, NULL, NULL, &seconds));
  PetscCall(EqmLedgerGetEarlier(solver->mesh->ledger, &earlier));
  seconds -= earlier;
  *stop = PETSC_TRUE;
  if (reason != EQM_STOP_NONE) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "stopped by %s after iteration %" PetscInt_FMT,
                            EqmStopReasonName(reason), solver->iteration));
  } else if (set->wall_time > 0. && seconds + Reserve(solver) >= set->wall_time) {
    PetscCall(
        PetscSNPrintf(solver->message, sizeof(solver->message), "stopped by -wall_time %g s", (double)set->wall_time));
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
