/* Version, error and status codes, errors that all ranks share, clocks and work counters. */
#ifndef EQUIMAP_BASE_H
#define EQUIMAP_BASE_H

#include <petscsys.h>

/* The version of these headers. EqmVersion gives that of the library. */
#define EQUIMAP_VERSION_MAJOR    0
#define EQUIMAP_VERSION_MINOR    1 /* its second number */
#define EQUIMAP_VERSION_SUBMINOR 0 /* its third number */

/* Is it MAJOR.MINOR.SUBMINOR? Like PETSC_VERSION_EQ, as are its relatives below; to be used behind \#if. */
#define EQUIMAP_VERSION_EQ(MAJOR, MINOR, SUBMINOR)                                                                     \
  ((EQUIMAP_VERSION_MAJOR == (MAJOR)) && (EQUIMAP_VERSION_MINOR == (MINOR)) && (EQUIMAP_VERSION_SUBMINOR == (SUBMINOR)))
/* Is the headers' version older than MAJOR.MINOR.SUBMINOR? */
#define EQUIMAP_VERSION_LT(MAJOR, MINOR, SUBMINOR)                                                                     \
  (EQUIMAP_VERSION_MAJOR < (MAJOR) ||                                                                                  \
   (EQUIMAP_VERSION_MAJOR == (MAJOR) &&                                                                                \
    (EQUIMAP_VERSION_MINOR < (MINOR) || (EQUIMAP_VERSION_MINOR == (MINOR) && EQUIMAP_VERSION_SUBMINOR < (SUBMINOR)))))
/* Is it that version or an older one? */
#define EQUIMAP_VERSION_LE(MAJOR, MINOR, SUBMINOR)                                                                     \
  (EQUIMAP_VERSION_LT(MAJOR, MINOR, SUBMINOR) || EQUIMAP_VERSION_EQ(MAJOR, MINOR, SUBMINOR))
/* Is it that version or a newer one? */
#define EQUIMAP_VERSION_GE(MAJOR, MINOR, SUBMINOR) (!EQUIMAP_VERSION_LT(MAJOR, MINOR, SUBMINOR))
/* Is it newer? */
#define EQUIMAP_VERSION_GT(MAJOR, MINOR, SUBMINOR) (!EQUIMAP_VERSION_LE(MAJOR, MINOR, SUBMINOR))

/* Error codes that library functions return beside PETSc's own. Each has an exit code of the program behind it.
   They lie outside the range of PETSc's codes, so that a caller can tell them apart. */
#define EQM_ERR_USAGE      ((PetscErrorCode)1002) /* wrong option or argument               -> exit code 2 */
#define EQM_ERR_MESH       ((PetscErrorCode)1003) /* the mesh cannot be mapped              -> exit code 3 */
#define EQM_ERR_IO         ((PetscErrorCode)1006) /* a file cannot be read or written       -> exit code 6 */
#define EQM_ERR_CHECKPOINT ((PetscErrorCode)1007) /* a checkpoint is damaged or of another problem -> exit code 7 */

/* How a run ended; the numbers are the program's exit codes. */
typedef enum {
  EQM_STATUS_CONVERGED = 0,
  EQM_STATUS_INTERNAL = 1,
  EQM_STATUS_USAGE = 2,
  EQM_STATUS_MESH = 3,
  EQM_STATUS_NOT_CONVERGED = 4,
  EQM_STATUS_FOLDS = 5,
  EQM_STATUS_IO = 6,
  EQM_STATUS_CHECKPOINT = 7,
  EQM_STATUS_STOPPED = 75
} EqmStatus;

/* Longest message that EqmFail carries, terminating zero included. */
#define EQM_MESSAGE_MAX 2048

/* EqmInitialize - start PETSc and MPI, and install equimap's error handler.

   Collective on MPI_COMM_WORLD, once. argc, argv - those of main; PETSc's options are read from them and from PETSc's
   own files and environment variables. With the handler, an error of EqmFail's is one line on the error stream, from
   rank 0, and its code comes back; any other error prints PETSc's trace and ends all ranks with exit code 1. A program
   that calls PetscInitialize itself need not call this: errors then come back with PETSc's usual traces. Errors: those
   of PetscInitialize. */
PETSC_EXTERN PetscErrorCode EqmInitialize(int *argc, char ***argv);
/* EqmFinalize - remove the error handler and end PETSc, and MPI if PETSc has started it.

   Collective on MPI_COMM_WORLD, after all objects have been destroyed. */
PETSC_EXTERN PetscErrorCode EqmFinalize(void);
/* EqmVersion - the library's version, "major.minor.subminor". Not collective. The string is constant. */
PETSC_EXTERN const char *EqmVersion(void);
/* EqmCommit - the git commit that the library was built from, or "unknown". Not collective. The string is constant. */
PETSC_EXTERN const char *EqmCommit(void);
/* EqmStatusName - a status in words, as summaries and result files carry it: "converged". Not collective. The string is
   constant; for a number that is no status it is "unknown". */
PETSC_EXTERN const char *EqmStatusName(EqmStatus status);
/* EqmStatusOfError - the status, and with it the exit code, for the code that a library function has returned.

   Not collective. 0 gives EQM_STATUS_CONVERGED, EQM_ERR_* their status, all others EQM_STATUS_INTERNAL. */
PETSC_EXTERN EqmStatus EqmStatusOfError(PetscErrorCode error);

/* EqmFail - return from the calling function with an error that all ranks of `comm` share; used like SETERRQ.

   Collective: every rank of `comm` must come here, since none continues. code - EQM_ERR_*; the message says what is
   wrong, where (in input numbering), and what to do; it is printed once, from rank 0. */
#define EqmFail(comm, code, ...)                                                                                       \
  return PetscError(comm, __LINE__, PETSC_FUNCTION_NAME, __FILE__, code, PETSC_ERROR_INITIAL, __VA_ARGS__)

/* EqmAgree - fail on all ranks if something has failed on one, so that none waits for a rank that has left.

   Collective on `comm`. code - 0 where all is well, else EQM_ERR_*; message - what went wrong, at most EQM_MESSAGE_MAX
   bytes, ignored where code is 0. Errors: code and message of the lowest rank whose code is not 0. */
PETSC_EXTERN PetscErrorCode EqmAgree(MPI_Comm comm, PetscErrorCode code, const char *message);

/* Phases of a run; their seconds appear in the summary. */
typedef enum {
  EQM_PHASE_READ,
  EQM_PHASE_DIAGNOSE,
  EQM_PHASE_DISTRIBUTE,
  EQM_PHASE_START,
  EQM_PHASE_MINIMISE,
  EQM_PHASE_CHECKPOINT,
  EQM_PHASE_MEASURE,
  EQM_PHASE_WRITE,
  EQM_NUM_PHASES
} EqmPhase;

/* Kinds of work inside the phases, as PETSc log events (shown by -log_view) and as seconds in the summary. */
typedef enum {
  EQM_EVENT_PARTITION, /* METIS: parts and fill-reducing ordering */
  EQM_EVENT_ASSEMBLE,
  EQM_EVENT_FACTOR,
  EQM_EVENT_SOLVE,
  EQM_EVENT_KERNEL, /* loops over cells */
  EQM_NUM_EVENTS
} EqmEvent;

/* Work done so far, counted on every rank alike. */
typedef struct {
  PetscInt64 evaluations;            /* energies, with or without gradient, residual evaluations included */
  PetscInt64 factorizations;         /* all numerical factorisations */
  PetscInt64 coupled_factorizations; /* those of matrices that couple the coordinates */
  PetscInt64 solves;                 /* right-hand sides solved */
  PetscInt64 cg_iterations;          /* of iterative solves */
  PetscInt64 set_ups;                /* of multigrid on a hierarchy of meshes */
} EqmWork;

/* Clocks and counters of a run. One per run; every object that works holds a reference to it. */
typedef struct _p_EqmLedger *EqmLedger;

/* EqmLedgerCreate - a ledger whose clock starts now.

   Collective. comm - the ranks of the run; ledger - to be freed with EqmLedgerDestroy after the objects that refer to
   it. Registers a PETSc log stage per phase and a log event per kind of work (-log_view shows them). */
PETSC_EXTERN PetscErrorCode EqmLedgerCreate(MPI_Comm comm, EqmLedger *ledger);
/* EqmLedgerDestroy - free a ledger. Collective. */
PETSC_EXTERN PetscErrorCode EqmLedgerDestroy(EqmLedger *ledger);
/* EqmPhaseBegin - start the clock of a phase. Collective; phases do not nest. */
PETSC_EXTERN PetscErrorCode EqmPhaseBegin(EqmLedger ledger, EqmPhase phase);
/* EqmPhaseEnd - stop the clock of a phase and add to its seconds. Collective. */
PETSC_EXTERN PetscErrorCode EqmPhaseEnd(EqmLedger ledger, EqmPhase phase);
/* EqmEventBegin - start the clock of a kind of work. Not collective; a kind does not nest in itself. */
PETSC_EXTERN PetscErrorCode EqmEventBegin(EqmLedger ledger, EqmEvent event);
/* EqmEventEnd - stop the clock of a kind of work and add to its seconds. Not collective. */
PETSC_EXTERN PetscErrorCode EqmEventEnd(EqmLedger ledger, EqmEvent event);
/* EqmLedgerGetWork - the work counters, to read and to add to. Not collective. work - belongs to the ledger. */
PETSC_EXTERN PetscErrorCode EqmLedgerGetWork(EqmLedger ledger, EqmWork **work);
/* EqmLedgerGetSeconds - wall-clock seconds so far, earlier runs that this one continues included.

   Collective. phases, total - rank 0's, so that they add up; events - the largest over the ranks; the same on every
   rank; NULL for what is not wanted. */
PETSC_EXTERN PetscErrorCode EqmLedgerGetSeconds(EqmLedger ledger, PetscReal phases[EQM_NUM_PHASES],
                                                PetscReal events[EQM_NUM_EVENTS], PetscReal *total);
/* EqmLedgerContinue - add the seconds of the runs that this one continues. Not collective.

   phases, events, total - as EqmLedgerGetSeconds gave them at the end of those runs. A second call replaces what the
   first has added. */
PETSC_EXTERN PetscErrorCode EqmLedgerContinue(EqmLedger ledger, const PetscReal phases[EQM_NUM_PHASES],
                                              const PetscReal events[EQM_NUM_EVENTS], PetscReal total);
/* EqmLedgerGetEarlier - the total that EqmLedgerContinue was given, in seconds; 0 without. Not collective. */
PETSC_EXTERN PetscErrorCode EqmLedgerGetEarlier(EqmLedger ledger, PetscReal *seconds);
/* EqmGetPeakMemory - peak resident memory in bytes, of the largest rank and summed over the ranks; the same on every
   rank. Collective. */
PETSC_EXTERN PetscErrorCode EqmGetPeakMemory(MPI_Comm comm, PetscInt64 *max_per_rank, PetscInt64 *total);

#endif
