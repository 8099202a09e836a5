/* One run at a time on a file. */
#ifndef EQM_LOCKFILE_H
#define EQM_LOCKFILE_H

#include <equimap/base.h>

typedef struct {
  char name[PETSC_MAX_PATH_LEN]; /* of the lock, FILE.lock; empty: none is held */
  int descriptor;                /* on rank 0 */
} EqmLock;

/* Take the lock of `file` until EqmLockRelease or the end of the process, however it ends: the lock is the operating
   system's (fcntl), on a file of its own, and not that file's existence. Where the file system has no locks, or the
   lock's file cannot be made, nothing is locked. `what` names the file's option in the message. Errors: EQM_ERR_USAGE
   (another process holds it). Collective. */
PETSC_INTERN PetscErrorCode EqmLockTake(MPI_Comm comm, const char *file, const char *what, EqmLock *lock);
/* Harmless where none is held. Not collective. */
PETSC_INTERN void EqmLockRelease(EqmLock *lock);

#endif
