/* Fixed ranges of the cell loops: partial sums by range are added in the order of the ranges, for any number of
   threads. */
#ifndef EQM_LOOPS_H
#define EQM_LOOPS_H

#include <equimap/mesh.h>

enum { EQM_NUM_RANGES = 64 };

/* First item of range b of n. */
static inline PetscInt EqmRangeStart(PetscInt n, PetscInt b)
{
  return (PetscInt)((PetscInt64)n * b / EQM_NUM_RANGES);
}

/* sum over owned cells of w x^power, power 1 or 2; x per local cell. Collective. */
PETSC_INTERN PetscErrorCode EqmWeightedSum(EqmMesh mesh, const PetscReal *x, PetscInt power, PetscReal *sum);
/* Subtract the weighted mean. Collective. */
PETSC_INTERN PetscErrorCode EqmRemoveWeightedMean(EqmMesh mesh, PetscReal *x);

#endif
