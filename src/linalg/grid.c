#include "linalg/grid.h"

/* Blocks of this size keep the dense kernels busy; each part of the grid should get some. */
enum { LARGEST_BLOCK = 64, SMALLEST_BLOCK = 4, BLOCKS_PER_PART = 4 };

EqmGrid EqmGridCreate(PetscMPIInt first, PetscMPIInt num_ranks, PetscInt n)
{
  EqmGrid grid = {.first = first, .rows = 1, .columns = 1, .block = 1};

  if (num_ranks == 1) return grid;
  while ((grid.rows + 1) * (grid.rows + 1) <= num_ranks) grid.rows++;
  grid.columns = num_ranks / grid.rows;
  grid.block = PetscMax(SMALLEST_BLOCK, PetscMin(LARGEST_BLOCK, n / (BLOCKS_PER_PART * grid.columns)));
  return grid;
}
