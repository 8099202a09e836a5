/* Dense matrices dealt to the ranks of a grid, in blocks and in turn, as ScaLAPACK wants them; a matrix on one rank is
   one on a grid of one rank, dealt in blocks of one. */
#ifndef EQM_GRID_H
#define EQM_GRID_H

#include <petscsys.h>

typedef struct {
  PetscMPIInt first;         /* the grid's ranks follow each other from here on, row by row */
  PetscMPIInt rows, columns; /* of ranks */
  PetscInt block;            /* rows and columns of a block */
} EqmGrid;

/* The grid for a matrix of `n` rows on ranks first .. first + num_ranks - 1: near to a square, so that up to the square
   root of the ranks get nothing; blocks such that all the others get several. Not collective. */
PETSC_INTERN EqmGrid EqmGridCreate(PetscMPIInt first, PetscMPIInt num_ranks, PetscInt n);

static inline PetscMPIInt EqmGridSize(EqmGrid grid)
{
  return grid.rows * grid.columns;
}

static inline PetscBool EqmGridHas(EqmGrid grid, PetscMPIInt rank)
{
  return (PetscBool)(rank >= grid.first && rank < grid.first + EqmGridSize(grid));
}

/* Row and column of a rank in the grid that has it, and the rank that is there. */
static inline PetscMPIInt EqmGridRow(EqmGrid grid, PetscMPIInt rank)
{
  return (rank - grid.first) / grid.columns;
}

static inline PetscMPIInt EqmGridColumn(EqmGrid grid, PetscMPIInt rank)
{
  return (rank - grid.first) % grid.columns;
}

static inline PetscMPIInt EqmGridRank(EqmGrid grid, PetscMPIInt row, PetscMPIInt column)
{
  return grid.first + row * grid.columns + column;
}

/* Rows or columns 0, 1, ... dealt to `parts` in blocks: the part that gets one, its number there, and back; how many of
   the first n a part gets. */
static inline PetscMPIInt EqmDealtTo(PetscInt index, PetscInt block, PetscMPIInt parts)
{
  return (PetscMPIInt)(index / block % parts);
}

static inline PetscInt EqmDealtAs(PetscInt index, PetscInt block, PetscMPIInt parts)
{
  return index / block / parts * block + index % block;
}

static inline PetscInt EqmDealtFrom(PetscInt local, PetscInt block, PetscMPIInt parts, PetscMPIInt part)
{
  return (local / block * parts + part) * block + local % block;
}

static inline PetscInt EqmDealtCount(PetscInt n, PetscInt block, PetscMPIInt parts, PetscMPIInt part)
{
  const PetscInt whole = n / block, more = whole % parts;

  return whole / parts * block + (part < more ? block : part == more ? n % block : 0);
}

#endif
