/* A registration as a long run: its minimisations, each with a checkpoint of its own, copies of its meshes beside them,
   requests to stop between its steps. */
#include "register/registration.h"
#include "solver/inner.h"
#include "store/keptmesh.h"
#include <libgen.h>

PetscErrorCode EqmStagesBegin(EqmRegistration r)
{
  EqmRegisterSettings *const set = &r->set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, NULL, "-checkpoint", set->checkpoint, sizeof(set->checkpoint), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-restart", set->restart, sizeof(set->restart), NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-wall_time", &set->wall_time, NULL));
  if (set->checkpoint[0]) PetscCall(EqmStopWatchFile(r->comm, set->checkpoint, &r->stop_file));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFirstRestart(EqmRegistration r, char name[PETSC_MAX_PATH_LEN], const char **restart)
{
  PetscFunctionBegin;
  *restart = NULL;
  if (!r->set.restart[0]) PetscFunctionReturn(0);
  PetscCall(PetscSNPrintf(name, PETSC_MAX_PATH_LEN, "%s.1", r->set.restart));
  *restart = name;
  PetscFunctionReturn(0);
}

/* Write the copy of one mesh and add its name to the checkpoint's entry. */
static PetscErrorCode Keep(EqmRegistration r, EqmSide *side)
{
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(EqmKeptMeshName(r->set.checkpoint, side->name, name, sizeof(name)));
  PetscCall(EqmSoupShift(side->soup, side->intake.unit));
  PetscCall(EqmKeptMeshWrite(side->soup, side->read, name, (PetscBool)(r->set.restart[0] != '\0')));
  PetscCall(EqmSoupShift(side->soup, -side->intake.unit));
  PetscCall(PetscStrlcat(r->kept, basename(name), sizeof(r->kept)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmKeepMeshes(EqmRegistration r)
{
  PetscFunctionBegin;
  if (!r->set.checkpoint[0]) PetscFunctionReturn(0);
  PetscCall(EqmPhaseBegin(r->ledger, EQM_PHASE_CHECKPOINT));
  PetscCall(Keep(r, &r->a));
  PetscCall(PetscStrlcat(r->kept, r->bare ? ",target" : ",", sizeof(r->kept)));
  if (!r->bare) PetscCall(Keep(r, &r->b));
  PetscCall(EqmPhaseEnd(r->ledger, EQM_PHASE_CHECKPOINT));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationMinimise(EqmRegistration r, EqmSolver solver)
{
  EqmStatus status;
  const char *message;

  PetscFunctionBegin;
  PetscCall(EqmSolverSetStage(solver, ++r->stage));
  PetscCall(EqmSolverSetStopFile(solver, &r->stop_file));
  PetscCall(EqmSolverSetKeptMesh(solver, r->kept));
  PetscCall(EqmSolverSolve(solver));
  PetscCall(EqmSolverCheckpointFailed(solver, &r->unsaved));
  PetscCall(EqmSolverGetStatus(solver, &status, &message));
  if (status != EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  r->status = status;
  r->stop_reported = (PetscBool)!r->set.quiet; /* by the solver */
  PetscCall(PetscStrncpy(r->message, message, sizeof(r->message)));
  PetscFunctionReturn(0);
}

/* Seconds of this run, without those of the earlier runs that it continues. */
static PetscErrorCode SecondsSoFar(EqmRegistration r, PetscReal *seconds)
{
  PetscReal earlier;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetSeconds(r->ledger, NULL, NULL, seconds));
  PetscCall(EqmLedgerGetEarlier(r->ledger, &earlier));
  *seconds -= earlier;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationCheckStop(EqmRegistration r, PetscBool clock)
{
  const char *const file = r->set.checkpoint;
  char by[64] = "-wall_time";
  EqmStopReason reason;
  PetscReal seconds;

  PetscFunctionBegin;
  if (!file[0] || r->unsaved || r->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  PetscCall(EqmStopRequested(r->comm, &r->stop_file, &reason));
  PetscCall(SecondsSoFar(r, &seconds));
  if (reason == EQM_STOP_NONE && !(clock && r->set.wall_time > 0. && seconds >= r->set.wall_time))
    PetscFunctionReturn(0);
  if (reason != EQM_STOP_NONE) PetscCall(PetscStrncpy(by, EqmStopReasonName(reason), sizeof(by)));
  r->status = EQM_STATUS_STOPPED;
  if (r->stage > 0)
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "stopped by %s after %" PetscInt_FMT
                            " minimisations; to go on: the same command with -restart %s",
                            by, r->stage, file));
  else
    PetscCall(PetscSNPrintf(r->message, sizeof(r->message),
                            "stopped by %s before the first iteration; to go on: the same command again", by));
  PetscFunctionReturn(0);
}
