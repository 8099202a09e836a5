/* Queries about files, with the same result on all ranks. */
#ifndef EQM_LOOKUP_H
#define EQM_LOOKUP_H

#include <petscsys.h>

/* Is there a file of that name? NULL is no file. Rank 0 checks. Collective. */
PETSC_INTERN PetscErrorCode EqmFileIsThere(MPI_Comm comm, const char *file, PetscBool *there);

#endif
