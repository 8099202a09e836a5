/* Fixed cuts of the cell loops: partial sums by range, added in the order of the ranges, whatever the threads do. */
#ifndef EQM_LOOPS_H
#define EQM_LOOPS_H

#include <equimap/mesh.h>

enum { EQM_NUM_RANGES = 64 };

/* First item of range b of n. */
static inline PetscInt EqmRangeStart(PetscInt n, PetscInt b)
{
  return (PetscInt)((PetscInt64)n * b / EQM_NUM_RANGES);
}

#endif
