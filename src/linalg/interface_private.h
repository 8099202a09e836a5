/* What building the tree, factoring and solving know of each other. */
#ifndef EQM_INTERFACE_PRIVATE_H
#define EQM_INTERFACE_PRIVATE_H

#include "linalg/interface.h"
#include "linalg/grid.h"
#include <petscblaslapack.h>

/* Of the messages between the ranks of two fronts. */
enum { EQM_TAG_SHAPE = 4101, EQM_TAG_MATRIX, EQM_TAG_UP, EQM_TAG_DOWN };

/* A merge of two groups of ranks, led by the lowest rank of the first. Its unknowns: those eliminated here, then those
   passed on. All ranks of both groups know its sizes; those whose entries move know the places, too. The panel has the
   columns of the eliminated unknowns, the kept ones' rows beginning with a whole round of blocks. */
typedef struct {
  PetscMPIInt low, high, right; /* ranks low .. high - 1; `right` leads the second group, low the first */
  PetscMPIInt side;             /* group of this rank, 0 or 1 */
  PetscInt num_out, num_kept;
  PetscInt num_from[2], *place[2]; /* where the unknowns of either group stand in this front */
  EqmGrid grid, from_grid[2];      /* that share this front; what either group passes on */
  PetscInt kept_begin;             /* row of the panel where the kept ones begin: num_out or more */
  PetscInt rows, kept_rows;        /* of the panel, and the kept ones' among them, that are on this rank */
  PetscInt out_columns;            /* of the panel, and of the matrix passed on, that are on this rank */
  PetscInt kept_columns;
  MPI_Comm comm;        /* of its ranks, if the grid has several */
  int handle, context;  /* of it in BLACS */
  PetscScalar *panel;   /* lower triangle of the factor, this rank's rows and columns */
  PetscScalar *columns; /* right-hand sides during a solve, like the panel's rows, in the grid's first column */
} EqmFront;

struct _p_EqmInterface {
  MPI_Comm comm;
  PetscMPIInt rank;
  PetscInt shared_front; /* fronts of more unknowns are shared */
  PetscInt num_fronts, num_shared;
  EqmFront *front; /* those whose groups this rank is in, from the leaf to the root */
};

/* A rank's part of a dense n x n matrix, or of columns of n numbers, which a group passes on. */
typedef struct {
  EqmGrid grid;
  PetscInt n, stride; /* stride: between columns */
  PetscScalar *values;
} EqmPassed;

/* Is this rank one of those that share the front? */
static inline PetscBool EqmFrontHas(const EqmFront *front, PetscMPIInt rank)
{
  return EqmGridHas(front->grid, rank);
}

static inline PetscBool EqmFrontIsShared(const EqmFront *front)
{
  return (PetscBool)(EqmGridSize(front->grid) > 1);
}

/* ---- from front to front (interface_move.c); collective over the ranks of the front */
/* Add what both groups pass on, the lower triangle of `passed`, to this front's panel and to what it passes on itself.
   Frees the former's values, `passed` becomes the latter. */
PETSC_INTERN PetscErrorCode EqmInterfaceMerge(EqmInterface tree, EqmFront *front, EqmPassed *passed);
/* Add both groups' columns to front->columns. */
PETSC_INTERN PetscErrorCode EqmInterfaceRaise(EqmInterface tree, EqmFront *front, PetscInt num_rhs,
                                              const EqmPassed *passed);
/* Fetch the solution from front->columns into `passed`, the group's columns. */
PETSC_INTERN PetscErrorCode EqmInterfaceLower(EqmInterface tree, EqmFront *front, PetscInt num_rhs, EqmPassed *passed);

/* ---- a front on several ranks, by ScaLAPACK (shared_front.c); collective over the ranks of the front's groups */
PETSC_INTERN PetscErrorCode EqmSharedFrontSetUp(EqmFront *front);
PETSC_INTERN PetscErrorCode EqmSharedFrontReset(EqmFront *front);
/* Eliminate: the factor's columns into the panel, `rest` less their product. `success` is set to false if the matrix is
   not definite. */
PETSC_INTERN PetscErrorCode EqmSharedFrontFactor(EqmFront *front, PetscScalar *rest, PetscBool *success);
/* L y = f, and what it leaves for the unknowns passed on; or L^T x = y, given x of those. In front->columns. */
PETSC_INTERN PetscErrorCode EqmSharedFrontSolve(EqmFront *front, PetscBool transposed, PetscInt num_rhs);

#endif
