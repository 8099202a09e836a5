/* Status codes, the house's way to fail, clocks and work counters. */
#ifndef EQUIMAP_BASE_H
#define EQUIMAP_BASE_H

#include <petscsys.h>

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

PETSC_EXTERN PetscErrorCode EqmInitialize(int *argc, char ***argv);
PETSC_EXTERN PetscErrorCode EqmFinalize(void);
PETSC_EXTERN const char *EqmVersion(void);
PETSC_EXTERN const char *EqmCommit(void);
PETSC_EXTERN const char *EqmStatusName(EqmStatus status);
PETSC_EXTERN EqmStatus EqmStatusOfError(PetscErrorCode error);

/* Fail on every rank of `comm` with one message (what is wrong, where, what to do), shown once, from rank 0.
   Collective in spirit: every rank must arrive here. Use like SETERRQ: it returns from the calling function. */
#define EqmFail(comm, code, ...)                                                                                       \
  return PetscError(comm, __LINE__, PETSC_FUNCTION_NAME, __FILE__, code, PETSC_ERROR_INITIAL, __VA_ARGS__)

/* Fail everywhere if one rank has failed: `code` (0 = fine) and `message` are taken from the lowest rank whose code is
   not 0. Collective on `comm`. */
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
} EqmWork;

/* The run's book-keeping: clocks and counters. One per run, handed to everything that works. */
typedef struct _p_EqmLedger *EqmLedger;
PETSC_EXTERN PetscErrorCode EqmLedgerCreate(MPI_Comm comm, EqmLedger *ledger);
PETSC_EXTERN PetscErrorCode EqmLedgerDestroy(EqmLedger *ledger);
PETSC_EXTERN PetscErrorCode EqmPhaseBegin(EqmLedger ledger, EqmPhase phase);
PETSC_EXTERN PetscErrorCode EqmPhaseEnd(EqmLedger ledger, EqmPhase phase);
PETSC_EXTERN PetscErrorCode EqmEventBegin(EqmLedger ledger, EqmEvent event);
PETSC_EXTERN PetscErrorCode EqmEventEnd(EqmLedger ledger, EqmEvent event);
PETSC_EXTERN PetscErrorCode EqmLedgerGetWork(EqmLedger ledger, EqmWork **work);
PETSC_EXTERN PetscErrorCode EqmLedgerGetSeconds(EqmLedger ledger, PetscReal phases[EQM_NUM_PHASES],
                                                PetscReal events[EQM_NUM_EVENTS], PetscReal *total);
PETSC_EXTERN PetscErrorCode EqmLedgerContinue(EqmLedger ledger, const PetscReal phases[EQM_NUM_PHASES],
                                              const PetscReal events[EQM_NUM_EVENTS], PetscReal total);
PETSC_EXTERN PetscErrorCode EqmLedgerGetEarlier(EqmLedger ledger, PetscReal *seconds);
PETSC_EXTERN PetscErrorCode EqmGetPeakMemory(MPI_Comm comm, PetscInt64 *max_per_rank, PetscInt64 *total);

#endif
