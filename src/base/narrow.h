/* Checked conversion of numbers for libraries whose integers may be narrower than PETSc's. */
#ifndef EQM_NARROW_H
#define EQM_NARROW_H

#include <petscsys.h>

/* EqmCheckFits - fail if a number does not fit a signed integer of `width` bytes; call it before every conversion to
   the integers of another library.

   Not collective. `library` and `what`: whose integers, and what is counted, for the message. Errors: PETSC_ERR_SUP. */
PETSC_INTERN PetscErrorCode EqmCheckFits(PetscInt64 number, size_t width, const char *library, const char *what);

/* EqmGatherCounts - how many records every rank has, and where they begin when they lie one after the other.

   Collective. `mine`: records of this rank; `count`, `start`: as many entries as ranks, and one more, for MPI's gathers
   and scatters. Errors, the same on every rank: PETSC_ERR_SUP if all together are more than MPI can count. */
PETSC_INTERN PetscErrorCode EqmGatherCounts(MPI_Comm comm, PetscInt64 mine, const char *what, PetscMPIInt *count,
                                            PetscMPIInt *start);

#endif
