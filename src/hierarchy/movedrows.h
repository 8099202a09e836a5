/* Rows of a block matrix that go to other ranks, again and again: first where they and their columns are, then their
   entries. */
#ifndef EQM_MOVEDROWS_H
#define EQM_MOVEDROWS_H

#include "hierarchy/blockmatrix.h"

typedef struct {
  EqmBlockMatrix matrix;       /* the rows of this rank; columns: they, then ghosts */
  PetscInt num_ghosts, *ghost; /* columns that are other ranks' rows: their numbers, ascending */
  PetscSF halo;                /* roots: rows; leaves: ghosts */
  PetscInt *begin;             /* per row: where its blocks begin, on the rank that it comes from */
  PetscSF entries;             /* roots: blocks that are moved; leaves: those of `matrix`; NULL on one rank alone */
} EqmMovedRows;

/* `rows`: roots, the rows of `from`; leaves, all rows of this rank, which are numbered rank by rank. `number`: of each
   column of `from`. Collective. */
PETSC_INTERN PetscErrorCode EqmMovedRowsCreate(PetscSF rows, const EqmBlockMatrix *from, const PetscInt *number,
                                               EqmMovedRows *to);
PETSC_INTERN PetscErrorCode EqmMovedRowsDestroy(EqmMovedRows *to);
/* The present entries of `from`. Collective. */
PETSC_INTERN PetscErrorCode EqmMovedRowsFill(const EqmBlockMatrix *from, EqmMovedRows *to);

#endif
