#include "base/quiet.h"
#include "base/fatal.h"

PetscErrorCode EqmKeepMessage(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                              PetscErrorType type, const char *message, void *context)
{
  if (EqmIsOutOfMemory(function, code, type)) return EqmFailForMemory(comm, code, type, message);
  if (type == PETSC_ERROR_INITIAL && message) (void)PetscStrncpy(context, message, EQM_MESSAGE_MAX);
  return code;
}

PetscErrorCode EqmWarn(MPI_Comm comm, const char *message, const char *consequence)
{
  PetscFunctionBegin;
  PetscCall(PetscFPrintf(comm, stderr, "equimap: warning: %s%s\n", message, consequence));
  PetscFunctionReturn(0);
}
