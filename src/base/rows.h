/* Rows of an array that is dealt to the ranks in contiguous slabs, fetched and put by their numbers. */
#ifndef EQM_ROWS_H
#define EQM_ROWS_H

#include <petscsf.h>

/* Fetch the `num` rows of those numbers, `width` units each, from slabs of `count` rows on each rank. Collective. */
PETSC_INTERN PetscErrorCode EqmFetchRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers,
                                         MPI_Datatype unit, PetscInt width, const void *slab, void *rows);
/* The same for the `num` rows from `start` on. Collective. */
PETSC_INTERN PetscErrorCode EqmFetchSlab(MPI_Comm comm, PetscInt count, PetscInt num, PetscInt start, MPI_Datatype unit,
                                         PetscInt width, const void *slab, void *rows);
/* From rows to slabs. Rows that no rank puts keep their values; no two ranks may put the same one. Collective. */
PETSC_INTERN PetscErrorCode EqmPutRows(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers,
                                       MPI_Datatype unit, PetscInt width, const void *rows, void *slab);

/* ---- for exchanges that are repeated */
/* The star forest from slabs, its roots, to rows by number, its leaves. Collective. */
PETSC_INTERN PetscErrorCode EqmRowsCreateSF(MPI_Comm comm, PetscInt count, PetscInt num, const PetscInt *numbers,
                                            PetscSF *sf);
/* Rows of `width` reals along any star forest; roots without leaves keep what they hold. Collective. */
PETSC_INTERN PetscErrorCode EqmRowsToLeaves(PetscSF sf, PetscInt width, const PetscReal *roots, PetscReal *leaves);
/* The same for rows of any kind. Collective. */
PETSC_INTERN PetscErrorCode EqmRowsOfToLeaves(PetscSF sf, MPI_Datatype unit, PetscInt width, const void *roots,
                                              void *leaves);
PETSC_INTERN PetscErrorCode EqmRowsToRoots(PetscSF sf, PetscInt width, const PetscReal *leaves, PetscReal *roots);

#endif
