/* A smoother for coupled systems: incomplete Cholesky without fill, in blocks of one vertex each. */
#ifndef EQM_BLOCKFACTOR_H
#define EQM_BLOCKFACTOR_H

#include "linalg/linalg.h"

typedef struct _p_EqmBlockFactor *EqmBlockFactor;
PETSC_INTERN PetscErrorCode EqmBlockFactorCreate(EqmMesh mesh, const EqmUnknowns *unknowns, EqmBlockFactor *factor);
PETSC_INTERN PetscErrorCode EqmBlockFactorDestroy(EqmBlockFactor *factor);
PETSC_INTERN PetscErrorCode EqmBlockFactorCompute(EqmBlockFactor factor, EqmCellMatrix cell_matrix, void *context);
PETSC_INTERN PetscErrorCode EqmBlockFactorSolve(EqmBlockFactor factor, const PetscReal *b, PetscReal *x);

#endif
