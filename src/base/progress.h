/* Telling people what a long run is at before its first iteration and after its last. */
#ifndef EQM_BASE_PROGRESS_H
#define EQM_BASE_PROGRESS_H

#include <equimap/base.h>

/* Called on every rank when a phase begins (seconds < 0) and when it has ended, with what it took on this rank. */
typedef PetscErrorCode (*EqmPhaseHook)(MPI_Comm comm, const char *phase, PetscReal seconds);

/* Let a ledger call `hook`; NULL: nothing. Not collective. */
PETSC_INTERN PetscErrorCode EqmLedgerSetHook(EqmLedger ledger, EqmPhaseHook hook);
/* Does the output go to a terminal, where a line can renew itself? A launcher may hand its ranks a pseudo-terminal
   though its own output goes to a file: under one, no. Not collective. */
PETSC_INTERN PetscBool EqmOnTerminal(void);
/* A hook for people: on a terminal the phase at hand on one line, which the next one overwrites; in a log a line for a
   phase that took long. */
PETSC_INTERN PetscErrorCode EqmPhasePrint(MPI_Comm comm, const char *phase, PetscReal seconds);

#endif
