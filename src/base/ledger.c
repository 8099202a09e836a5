/* Clocks and counters of a run: seconds per phase and per kind of work, counted work, peak memory. */
#include <equimap/base.h>
#include "base/progress.h"
#include <sys/resource.h>

struct _p_EqmLedger {
  MPI_Comm comm;
  EqmPhaseHook hook;
  EqmWork work;
  PetscLogStage stage[EQM_NUM_PHASES];
  PetscLogEvent event[EQM_NUM_EVENTS];
  PetscLogDouble created, phase_begun[EQM_NUM_PHASES], event_begun[EQM_NUM_EVENTS];
  PetscReal phase_seconds[EQM_NUM_PHASES], event_seconds[EQM_NUM_EVENTS];
  PetscReal earlier_phases[EQM_NUM_PHASES], earlier_events[EQM_NUM_EVENTS], earlier; /* of the runs before this one */
};

static const char *const phase_names[EQM_NUM_PHASES] = {"Read",     "Diagnose",   "Distribute", "Start",
                                                        "Minimise", "Checkpoint", "Measure",    "Write"};
static const char *const event_names[EQM_NUM_EVENTS] = {"EqmPartition", "EqmAssemble", "EqmFactor", "EqmSolve",
                                                        "EqmKernel"};

/* Stages and events are PETSc's and outlive a ledger: find those that an earlier ledger registered. */
static PetscErrorCode RegisterLogging(EqmLedger ledger)
{
  PetscClassId class_id;

  PetscFunctionBegin;
  for (int p = 0; p < EQM_NUM_PHASES; p++) {
    PetscCall(PetscLogStageGetId(phase_names[p], &ledger->stage[p]));
    if (ledger->stage[p] < 0) PetscCall(PetscLogStageRegister(phase_names[p], &ledger->stage[p]));
  }
  PetscCall(PetscLogEventGetId(event_names[0], &ledger->event[0]));
  if (ledger->event[0] < 0) PetscCall(PetscClassIdRegister("equimap", &class_id));
  for (int e = 0; e < EQM_NUM_EVENTS; e++) {
    PetscCall(PetscLogEventGetId(event_names[e], &ledger->event[e]));
    if (ledger->event[e] < 0) PetscCall(PetscLogEventRegister(event_names[e], class_id, &ledger->event[e]));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerCreate(MPI_Comm comm, EqmLedger *out)
{
  EqmLedger ledger;

  PetscFunctionBegin;
  PetscCall(PetscNew(&ledger));
  ledger->comm = comm;
  PetscCall(PetscTime(&ledger->created));
  PetscCall(RegisterLogging(ledger));
  *out = ledger;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerDestroy(EqmLedger *ledger)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*ledger));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerSetHook(EqmLedger ledger, EqmPhaseHook hook)
{
  PetscFunctionBegin;
  ledger->hook = hook;
  PetscFunctionReturn(0);
}

/* Iterations and checkpoints are told of by others. */
static PetscErrorCode CallHook(EqmLedger ledger, EqmPhase phase, PetscReal seconds)
{
  PetscFunctionBegin;
  if (ledger->hook && phase != EQM_PHASE_MINIMISE && phase != EQM_PHASE_CHECKPOINT)
    PetscCall(ledger->hook(ledger->comm, phase_names[phase], seconds));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPhaseBegin(EqmLedger ledger, EqmPhase phase)
{
  PetscFunctionBegin;
  PetscCall(CallHook(ledger, phase, -1.));
  PetscCall(PetscLogStagePush(ledger->stage[phase]));
  PetscCall(PetscTime(&ledger->phase_begun[phase]));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPhaseEnd(EqmLedger ledger, EqmPhase phase)
{
  PetscLogDouble now;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  ledger->phase_seconds[phase] += now - ledger->phase_begun[phase];
  PetscCall(PetscLogStagePop());
  PetscCall(CallHook(ledger, phase, now - ledger->phase_begun[phase]));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmEventBegin(EqmLedger ledger, EqmEvent event)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(ledger->event[event], 0, 0, 0, 0));
  PetscCall(PetscTime(&ledger->event_begun[event]));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmEventEnd(EqmLedger ledger, EqmEvent event)
{
  PetscLogDouble now;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  ledger->event_seconds[event] += now - ledger->event_begun[event];
  PetscCall(PetscLogEventEnd(ledger->event[event], 0, 0, 0, 0));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerGetWork(EqmLedger ledger, EqmWork **work)
{
  PetscFunctionBegin;
  *work = &ledger->work;
  PetscFunctionReturn(0);
}

/* Phases are collective: the ranks differ by how long they wait for each other. */
PetscErrorCode EqmLedgerGetSeconds(EqmLedger ledger, PetscReal phases[EQM_NUM_PHASES], PetscReal events[EQM_NUM_EVENTS],
                                   PetscReal *total)
{
  PetscLogDouble now;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  if (phases) {
    PetscCall(PetscArraycpy(phases, ledger->phase_seconds, EQM_NUM_PHASES));
    PetscCallMPI(MPI_Bcast(phases, EQM_NUM_PHASES, MPIU_REAL, 0, ledger->comm));
  }
  if (events)
    PetscCall(MPIU_Allreduce(ledger->event_seconds, events, EQM_NUM_EVENTS, MPIU_REAL, MPIU_MAX, ledger->comm));
  if (total) {
    *total = now - ledger->created;
    PetscCallMPI(MPI_Bcast(total, 1, MPIU_REAL, 0, ledger->comm));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerContinue(EqmLedger ledger, const PetscReal phases[EQM_NUM_PHASES],
                                 const PetscReal events[EQM_NUM_EVENTS], PetscReal total)
{
  PetscFunctionBegin;
  for (int p = 0; p < EQM_NUM_PHASES; p++) ledger->phase_seconds[p] += phases[p] - ledger->earlier_phases[p];
  for (int e = 0; e < EQM_NUM_EVENTS; e++) ledger->event_seconds[e] += events[e] - ledger->earlier_events[e];
  ledger->created -= total - ledger->earlier;
  PetscCall(PetscArraycpy(ledger->earlier_phases, phases, EQM_NUM_PHASES));
  PetscCall(PetscArraycpy(ledger->earlier_events, events, EQM_NUM_EVENTS));
  ledger->earlier = total;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLedgerGetEarlier(EqmLedger ledger, PetscReal *seconds)
{
  PetscFunctionBegin;
  *seconds = ledger->earlier;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGetPeakMemory(MPI_Comm comm, PetscInt64 *max_per_rank, PetscInt64 *total)
{
  struct rusage usage;
  PetscInt64 mine;

  PetscFunctionBegin;
  PetscCheck(getrusage(RUSAGE_SELF, &usage) == 0, PETSC_COMM_SELF, PETSC_ERR_SYS, "getrusage failed");
  mine = (PetscInt64)usage.ru_maxrss * 1024; /* Linux counts in KiB */
  PetscCall(MPIU_Allreduce(&mine, max_per_rank, 1, MPIU_INT64, MPI_MAX, comm));
  PetscCall(MPIU_Allreduce(&mine, total, 1, MPIU_INT64, MPI_SUM, comm));
  PetscFunctionReturn(0);
}
