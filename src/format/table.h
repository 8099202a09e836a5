/* Tables of numbers from CSV files. */
#ifndef EQM_TABLE_H
#define EQM_TABLE_H

#include <equimap/base.h>

enum { EQM_MOST_COLUMNS = 16, EQM_COLUMN_NAME = 32 };

typedef struct {
  PetscInt rows, columns;
  char name[EQM_MOST_COLUMNS][EQM_COLUMN_NAME]; /* of the columns, on every rank; what is longer is cut off */
  PetscReal *values;                            /* on rank 0: rows * columns; PetscFree it */
} EqmTable;

/* Read a header line and rows of between `least` and `most` numbers, as many in each row. Numbers are separated by
   commas, semicolons or tabs. `wanted` tells in messages what a row should be. Errors: EQM_ERR_IO. Collective. */
PETSC_INTERN PetscErrorCode EqmTableRead(MPI_Comm comm, const char *file, PetscInt least, PetscInt most,
                                         const char *wanted, EqmTable *table);

#endif
