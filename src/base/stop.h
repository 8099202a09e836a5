/* Requests to stop that come from outside while a run is under way. */
#ifndef EQM_STOP_H
#define EQM_STOP_H

#include <petscsys.h>

/* Where a request came from; the larger number is told where there are several. */
typedef enum { EQM_STOP_NONE, EQM_STOP_USR1, EQM_STOP_TERM, EQM_STOP_FILE } EqmStopReason;

/* From here on SIGTERM, SIGINT and SIGHUP end this process as they always do, without PETSc's trace, and no temporary
   file stays behind. Not collective. */
PETSC_INTERN void EqmStopRemoveTemporaries(void);

/* From here on SIGUSR1 and SIGTERM are noted on every rank instead of ending the processes. Collective. */
PETSC_INTERN PetscErrorCode EqmStopCatchSignals(MPI_Comm comm);

/* Watch for a file called STOP in the folder of `file`. One that is there already does not count until it is touched.
   Collective in spirit: rank 0 looks. */
typedef struct {
  char name[PETSC_MAX_PATH_LEN]; /* empty: nothing to watch */
  long long stamp[3];            /* of what lies there: inode, seconds, nanoseconds; zeros: nothing */
} EqmStopFile;
PETSC_INTERN PetscErrorCode EqmStopWatchFile(MPI_Comm comm, const char *file, EqmStopFile *watch);

/* Was a stop requested on any rank? The same result on all. `watch` may be NULL. Collective. */
PETSC_INTERN PetscErrorCode EqmStopRequested(MPI_Comm comm, const EqmStopFile *watch, EqmStopReason *reason);
/* In words. Not collective. */
PETSC_INTERN const char *EqmStopReasonName(EqmStopReason reason);

#endif
