/* Status codes, the error handler, agreement on failures. */
#include <equimap/base.h>
#include "base/atomicfile.h"
#include "base/fatal.h"
#include "base/stop.h"
#include <signal.h>
#include <string.h>

#ifndef EQM_VERSION
#error "EQM_VERSION comes from the build system"
#endif

const char *EqmVersion(void)
{
  return EQM_VERSION;
}

const char *EqmCommit(void)
{
  return EQM_COMMIT;
}

const char *EqmStatusName(EqmStatus status)
{
  switch (status) {
  case EQM_STATUS_CONVERGED:
    return "converged";
  case EQM_STATUS_INTERNAL:
    return "internal error";
  case EQM_STATUS_USAGE:
    return "wrong usage";
  case EQM_STATUS_MESH:
    return "mesh cannot be mapped";
  case EQM_STATUS_NOT_CONVERGED:
    return "not converged";
  case EQM_STATUS_FOLDS:
    return "folds remain";
  case EQM_STATUS_IO:
    return "input or output failed";
  case EQM_STATUS_CHECKPOINT:
    return "checkpoint refused";
  case EQM_STATUS_STOPPED:
    return "stopped on request";
  }
  return "unknown";
}

EqmStatus EqmStatusOfError(PetscErrorCode error)
{
  if (error == 0) return EQM_STATUS_CONVERGED;
  if (error == EQM_ERR_USAGE) return EQM_STATUS_USAGE;
  if (error == EQM_ERR_MESH) return EQM_STATUS_MESH;
  if (error == EQM_ERR_IO) return EQM_STATUS_IO;
  if (error == EQM_ERR_CHECKPOINT) return EQM_STATUS_CHECKPOINT;
  return EQM_STATUS_INTERNAL;
}

PetscErrorCode EqmAgree(MPI_Comm comm, PetscErrorCode code, const char *message)
{
  PetscMPIInt rank, size, failed;
  int mine, shared = (int)code;
  char text[EQM_MESSAGE_MAX] = "";

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  mine = code ? rank : size;
  PetscCallMPI(MPI_Allreduce(&mine, &failed, 1, MPI_INT, MPI_MIN, comm));
  if (failed == size) PetscFunctionReturn(0);
  if (rank == failed) PetscCall(PetscStrncpy(text, message ? message : "no reason given", sizeof(text)));
  PetscCallMPI(MPI_Bcast(text, (PetscMPIInt)sizeof(text), MPI_CHAR, failed, comm));
  PetscCallMPI(MPI_Bcast(&shared, 1, MPI_INT, failed, comm));
  EqmFail(comm, (PetscErrorCode)shared, "%s", text);
}

/* A user's mistake deserves a sentence, once, not a stack of calls from every rank, and so does memory that is not
   there; a bug keeps PETSc's full trace. Either of these two ends all ranks, for the others may be waiting. */
static PetscErrorCode HandleError(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                                  PetscErrorType type, const char *message, void *context)
{
  if (EqmIsOutOfMemory(function, code, type)) return EqmFailForMemory(comm, code, type, message);
  if (EqmStatusOfError(code) != EQM_STATUS_INTERNAL) {
    PetscMPIInt rank = 0;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (type == PETSC_ERROR_INITIAL && rank == 0) fprintf(stderr, "equimap: %s\n", message);
    return code;
  }
  if (function &&
      !strncmp(function, "PetscOptions", 12)) { /* an option's value that is no number, or none of the choices */
    PetscMPIInt rank = 0;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank == 0) fprintf(stderr, "equimap: wrong value of an option: %s\n", message ? message : "no reason given");
    return EQM_ERR_USAGE;
  }
  PetscTraceBackErrorHandler(comm, line, function, file, code, type, message, context);
  EqmEndAllRanks();
}

PetscErrorCode EqmInitialize(int *argc, char ***argv)
{
  PetscFunctionBegin;
  if (PetscPushErrorHandler(HandleError, NULL)) { /* what fails from here on deserves a sentence, too */
    EqmRefuseToBegin(0);
    return PETSC_ERR_MEM;
  }
  PetscCall(PetscInitialize(argc, argv, NULL, NULL));
  EqmStopRemoveTemporaries();
  PetscCall(EqmWatchEnds());
  signal(SIGXFSZ, SIG_IGN); /* a file size limit is a write that fails, with a message, not a death */
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFinalize(void)
{
  PetscBool traces_memory;

  PetscFunctionBegin;
  EqmForgetEnds();
  EqmAtomicAbandonAll(); /* of functions that have failed */
  PetscCall(PetscMallocGetDebug(&traces_memory, NULL, NULL));
  if (!traces_memory) PetscCall(PetscPopErrorHandler()); /* it is older than the tracing, which takes it for a fault */
  PetscCall(PetscFinalize());
  return 0;
}
