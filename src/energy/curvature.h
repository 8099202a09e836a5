/* Derivatives of one cell's image measure by the degrees of freedom of its corners. */
#ifndef EQM_CURVATURE_H
#define EQM_CURVATURE_H

#include "energy/cellframe.h"

typedef struct {
  EqmCellFrame frame; /* the degrees of freedom */
  PetscReal first[EQM_MOST_CELL_DOFS];
  PetscReal second[EQM_MOST_CELL_DOFS][EQM_MOST_CELL_DOFS]; /* along geodesics */
} EqmCellDerivatives;

PETSC_INTERN void EqmCellDifferentiate(EqmDomain domain, const EqmPlace *place, PetscInt cell,
                                       EqmCellDerivatives *derivatives);

#endif
