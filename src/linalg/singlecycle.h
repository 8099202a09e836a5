/* A cycle of multigrid in single precision on the levels that PETSc's aggregation has made, for matrices that are only
   applied, as metrics are: it reads 36 bytes for a block of nine entries where theirs read 108, and runs on the
   threads. Symmetric sweeps before and after (singlesweeps.h) make it a symmetric definite operator. */
#ifndef EQM_SINGLECYCLE_H
#define EQM_SINGLECYCLE_H

#include <petscksp.h>

typedef struct _p_EqmSingleCycle *EqmSingleCycle;
/* Take the present entries of all levels of `pc`, which is set up; `cycle` is made if it is NULL, from patterns and
   prolongations that must then stay until it is destroyed. NULL is left where there is no such cycle: `pc` is not of
   type gamg, has one level alone, or one without three unknowns for every vertex or aggregate, or its numbers are
   beyond single precision. Collective. */
PETSC_INTERN PetscErrorCode EqmSingleCycleRenew(PC pc, EqmSingleCycle *cycle);
PETSC_INTERN PetscErrorCode EqmSingleCycleDestroy(EqmSingleCycle *cycle);
/* x = B b, in the layout of the matrix. Collective. */
PETSC_INTERN PetscErrorCode EqmSingleCycleApply(EqmSingleCycle cycle, Vec b, Vec x);

#endif
