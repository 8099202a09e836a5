#ifndef EQM_CSVTABLE_H
#define EQM_CSVTABLE_H

#include <equimap/base.h>

/* Write a CSV file: `header`, then a line per cell or vertex, its number first, of which there are `num`. This rank has
   `count` of them, in the order of the ranks; `second`, the other column, may be NULL. Collective. */
PETSC_INTERN PetscErrorCode EqmCsvTableWrite(MPI_Comm comm, const char *file, const char *header, PetscInt num,
                                             PetscInt count, const PetscReal *first, const PetscReal *second);

#endif
