/* Rows of an array that is dealt to the ranks in contiguous slabs, asked for and left by their numbers. */
#ifndef EQM_ROWS_H
#define EQM_ROWS_H

#include <petscsys.h>

/* Fetch the `num` rows of those numbers, `width` units each, from slabs of `count` rows on each rank. Collective. */
PETSC_INTERN PetscErrorCode EqmFetchRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers,
                                         MPI_Datatype unit, PetscInt width, const void *slab, void *rows);
/* The other way. Rows that nobody leaves keep what they hold; no two ranks may leave the same one. Collective. */
PETSC_INTERN PetscErrorCode EqmLeaveRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers,
                                         MPI_Datatype unit, PetscInt width, const void *rows, void *slab);

#endif
