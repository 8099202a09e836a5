/* What a checkpoint holds. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include "base/checksum.h"
#include "store/columns.h"
#include "store/keptmesh.h"

/* Row after row: the iteration, the columns of a history, the objective; the columns are told in an attribute. */
enum { WIDTH = EQM_NUM_HISTORY_COLUMNS + 2 };

static PetscErrorCode NameColumns(char *text, size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, "iteration, ", length));
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) {
    PetscCall(PetscStrlcat(text, EqmHistoryColumns[k].name, length));
    PetscCall(PetscStrlcat(text, ", ", length));
  }
  PetscCall(PetscStrlcat(text, "objective", length));
  PetscFunctionReturn(0);
}

static PetscErrorCode VisitHistory(EqmState state, EqmSolver solver)
{
  char columns[EQM_MESSAGE_MAX];
  PetscReal *packed;
  PetscInt rows = solver->num_history;

  PetscFunctionBegin;
  PetscCall(NameColumns(columns, sizeof(columns)));
  PetscCall(EqmStateSameText(state, "history_columns", columns));
  PetscCall(EqmStateInt(state, "num_history", &rows));
  PetscCall(PetscMalloc1(WIDTH * rows, &packed));
  for (PetscInt k = 0; k < solver->num_history; k++) {
    packed[WIDTH * k] = solver->history[k].iteration;
    EqmHistoryPack(&solver->history[k], packed + WIDTH * k + 1);
    packed[WIDTH * k + WIDTH - 1] = solver->objectives[k];
  }
  PetscCall(EqmStateReals(state, "history", WIDTH * rows, packed));
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmHistoryReserve(solver, rows));
    for (PetscInt k = 0; k < rows; k++) {
      solver->history[k].iteration = (PetscInt)packed[WIDTH * k];
      EqmHistoryUnpack(packed + WIDTH * k + 1, &solver->history[k]);
      solver->objectives[k] = packed[WIDTH * k + WIDTH - 1];
    }
    solver->num_history = rows;
  }
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(0);
}

/* The same landmarks, and the places that they had: computed anew, as those of a registration are, they would be others
   by rounding. */
static PetscErrorCode VisitLandmarks(EqmState state, EqmSolver solver)
{
  EqmLandmarks *const landmarks = &solver->problem->landmarks;
  const PetscReal rounding = 1e-6;
  const PetscInt count = landmarks->dim * landmarks->num_total;
  PetscReal *places, largest = 0.;

  PetscFunctionBegin;
  PetscCall(EqmStateSameInt(state, "the number of landmarks", landmarks->num_total));
  PetscCall(EqmStateSameReal(state, "the landmarks' weight", landmarks->lambda));
  if (landmarks->num_total == 0) PetscFunctionReturn(0);
  PetscCall(EqmStateSameInt(state, "the checksum of the landmarks' vertices",
                            EqmChecksumIntegers(landmarks->num_total, landmarks->input_vertex).crc));
  PetscCall(EqmStateSameInt(state, "the checksum of the landmarks' weights",
                            EqmChecksumReals(landmarks->num_total, landmarks->given_weight).crc));
  PetscCall(PetscMalloc1(count, &places));
  PetscCall(PetscArraycpy(places, landmarks->target, count));
  PetscCall(EqmStateReals(state, "landmark_places", count, places));
  for (PetscInt k = 0; k < count; k++) largest = PetscMax(largest, PetscAbsReal(places[k] - landmarks->target[k]));
  if (largest <= rounding) PetscCall(PetscArraycpy(landmarks->target, places, count));
  PetscCall(PetscFree(places));
  if (!(largest <= rounding))
    EqmFail(solver->comm, EQM_ERR_CHECKPOINT,
            "the checkpoint's landmarks lie elsewhere, by up to %.3g in the target; begin anew, without -restart",
            (double)largest);
  PetscFunctionReturn(0);
}

/* Refuse the checkpoint of another problem. */
static PetscErrorCode VisitProblem(EqmState state, EqmSolver solver)
{
  const EqmSolverSettings *const set = &solver->settings;
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
  PetscCall(EqmStateSameText(state, "method", solver->defaults.name));
  PetscCall(EqmStateSameReal(state, "-balance", PetscMax(set->balance, 0.)));
  PetscCall(EqmStateSameText(state, "-corners", corners));
  PetscCall(VisitLandmarks(state, solver));
  PetscFunctionReturn(0);
}

/* Clocks continue from the saved seconds. */
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

/* Name of the copy of the mesh beside the checkpoint, for a restart without the mesh itself. */
static PetscErrorCode VisitKeptMesh(EqmState state, EqmSolver solver)
{
  char copy[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(copy, solver->checkpoints.kept_mesh, sizeof(copy)));
  PetscCall(EqmStateText(state, EQM_KEPT_MESH, copy, sizeof(copy)));
  PetscFunctionReturn(0);
}

/* The part that is loaded before the method is set up. */
PetscErrorCode EqmCheckpointVisitMap(EqmState state, EqmSolver solver)
{
  PetscInt status = (PetscInt)solver->status;

  PetscFunctionBegin;
  PetscCall(VisitProblem(state, solver));
  PetscCall(VisitKeptMesh(state, solver));
  PetscCall(EqmStatePlace(state, solver->problem->domain, "map", &solver->iterate->place));
  PetscCall(EqmStateGroup(state, "solver"));
  PetscCall(EqmStateInt(state, "iteration", &solver->iterate->number));
  PetscCall(EqmStateInt64(state, "unfolded_from", &solver->iterate->unfolded_from));
  PetscCall(EqmStateInt64(state, "unfolded_to", &solver->iterate->unfolded_to));
  PetscCall(EqmStateInt(state, "begun_again", &solver->begun_again));
  PetscCall(EqmStateBool(state, "finished", &solver->checkpoints.finished));
  PetscCall(EqmStateInt(state, "status", &status));
  PetscCall(EqmStateText(state, "message", solver->message, sizeof(solver->message)));
  solver->status = (EqmStatus)status;
  PetscCall(VisitHistory(state, solver));
  PetscCall(VisitSeconds(state, solver));
  PetscFunctionReturn(0);
}

/* The rest: the method's state, then the map, figures and counters that set_up may have changed. */
PetscErrorCode EqmCheckpointVisitMethod(EqmState state, EqmSolver solver)
{
  EqmWork *work;

  PetscFunctionBegin;
  if (EqmStateIsLoading(state)) {
    PetscCall(EqmStateGroup(state, ""));
    PetscCall(EqmStatePlace(state, solver->problem->domain, "map", &solver->iterate->place));
    PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  }
  PetscCall(EqmStateGroup(state, solver->defaults.name));
  PetscCall(EqmMethodVisitState(solver->method, solver->iterate, state));
  PetscCall(EqmStateGroup(state, "solver"));
  PetscCall(EqmStateReal(state, "objective", &solver->iterate->objective));
  PetscCall(EqmStateReal(state, "gradient_norm", &solver->iterate->gradient_norm));
  PetscCall(EqmStateReal(state, "step_length", &solver->iterate->step_length));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  PetscCall(EqmStateInt64(state, "evaluations", &work->evaluations));
  PetscCall(EqmStateInt64(state, "factorizations", &work->factorizations));
  PetscCall(EqmStateInt64(state, "coupled_factorizations", &work->coupled_factorizations));
  PetscCall(EqmStateInt64(state, "solves", &work->solves));
  PetscCall(EqmStateInt64(state, "cg_iterations", &work->cg_iterations));
  PetscCall(EqmStateInt64(state, "set_ups", &work->set_ups));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCheckpointVisit(EqmState state, void *context)
{
  PetscFunctionBegin;
  PetscCall(EqmCheckpointVisitMap(state, context));
  PetscCall(EqmCheckpointVisitMethod(state, context));
  PetscFunctionReturn(0);
}
