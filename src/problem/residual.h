/* Residuals of the ratios of a map's cells: what a Gauss-Newton method makes of an objective that is least where all
   ratios are one. The leading term is sum w rho(l)^2, l = log((a/w)/A), a the measure of a cell's image. */
#ifndef EQM_RESIDUAL_H
#define EQM_RESIDUAL_H

#include "problem/problem.h"

typedef struct {
  const char *name;
  /* rho and its first two derivatives by l. Not collective. */
  void (*at)(PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second);
  /* rho less its weighted mean: the total A is free, and a rank-one term belongs to the matrix. Otherwise A is that of
     the map that an iteration begins with. */
  PetscBool without_mean;
} EqmResidual;

/* log r; r - 1 where r > 1, else log r: this reaches the minimum straight from a Tutte map; r - 1, whose sum of squares
   is the normalised authalic energy over A (docs/methods.md). */
PETSC_INTERN const EqmResidual EqmResidualLog, EqmResidualMixed, EqmResidualRatio;
/* Errors: EQM_ERR_USAGE (no such residual). Collective. */
PETSC_INTERN PetscErrorCode EqmResidualFind(MPI_Comm comm, const char *name, const EqmResidual **residual);

#endif
