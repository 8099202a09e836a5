/* Matrices of 2 x 2 blocks whose rows are dealt to the ranks, in compressed rows: what PETSc's general products take
   several times as long for. */
#ifndef EQM_SHAREDROWS_H
#define EQM_SHAREDROWS_H

#include "hierarchy/blockmatrix.h"

typedef struct {
  PetscInt num_rows, first; /* of this rank; the number of its first among those of all */
  PetscInt *start, *column; /* num_rows + 1; per block, numbered over all ranks; -1: none */
  EqmBlock *entry;
} EqmSharedRows;

/* Room for so many rows of so many blocks each. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRowsCreate(MPI_Comm comm, PetscInt num_rows, PetscInt width, EqmSharedRows *rows);
PETSC_INTERN PetscErrorCode EqmSharedRowsDestroy(EqmSharedRows *rows);
/* P^T A P; this rank gets num_columns of P's columns as rows. The rows of A and P are dealt alike. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedGalerkin(MPI_Comm comm, const EqmSharedRows *a, const EqmSharedRows *p,
                                              PetscInt num_columns, EqmSharedRows *product);
/* As a matrix of PETSc's with two rows per row and two columns per column, of which this rank has num_columns; zeros
   left out. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedRowsMatrix(MPI_Comm comm, const EqmSharedRows *rows, PetscInt num_columns,
                                                Mat *matrix);

#endif
