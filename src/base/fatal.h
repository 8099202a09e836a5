/* Errors after which one rank cannot go on, nor wait for the others: memory that is not there, and bugs. */
#ifndef EQM_FATAL_H
#define EQM_FATAL_H

#include <equimap/base.h>

/* Is it an allocation that failed? PETSc 3.18 says so by the function that raises the error: the code that it raises
   with it is a line number, which may even be one of ours. Not collective. */
PETSC_INTERN PetscBool EqmIsOutOfMemory(const char *function, PetscErrorCode code, PetscErrorType type);

/* What an error handler does then. Where all ranks of `comm` share the error (it was raised by EqmAgree) the first of
   them says so and the code comes back; a rank that is alone with it says so and ends all ranks with exit code 1.
   `message` may be NULL. Not collective. */
PETSC_INTERN PetscErrorCode EqmFailForMemory(MPI_Comm comm, PetscErrorCode code, PetscErrorType type,
                                             const char *message);

/* End all ranks with exit code 1; temporary files are removed. Not collective. */
PETSC_INTERN void EqmEndAllRanks(void) __attribute__((noreturn));

/* Memory that is missing before there is a handler of errors: rank 0 says so; ends are watched no
   more. Not collective. */
PETSC_INTERN void EqmRefuseToBegin(int rank);

/* From now until EqmForgetEnds an exit that a library calls ends all ranks so, with a sentence; MPI need not have
   begun. Not collective. */
PETSC_INTERN void EqmWatchExits(void);

/* A crash, too, unless -no_signal_handler is given. Once. Not collective. */
PETSC_INTERN PetscErrorCode EqmWatchEnds(void);
PETSC_INTERN void EqmForgetEnds(void);

/* Ask for the work space of the BLAS now. Errors: PETSC_ERR_MEM. Not collective. */
PETSC_INTERN PetscErrorCode EqmReserveForBlas(void);

#endif
