/* Errors that are no reason to end. */
#ifndef EQM_QUIET_H
#define EQM_QUIET_H

#include <equimap/base.h>

/* An error handler that prints nothing and keeps the message, for PetscPushErrorHandler around a call that may fail;
   `context` is a char[EQM_MESSAGE_MAX]. A rank that runs out of memory ends all nevertheless: the others wait. */
PETSC_INTERN PetscErrorCode EqmKeepMessage(MPI_Comm comm, int line, const char *function, const char *file,
                                           PetscErrorCode code, PetscErrorType type, const char *message,
                                           void *context);
/* A sentence on the screen, once: "equimap: warning: " and both parts. Collective. */
PETSC_INTERN PetscErrorCode EqmWarn(MPI_Comm comm, const char *message, const char *consequence);

#endif
