/* Derivatives of one cell's image measure by the degrees of freedom of its corners. */
#ifndef EQM_CURVATURE_H
#define EQM_CURVATURE_H

#include <equimap/energy.h>

enum { EQM_MOST_CELL_DOFS = 12 };

typedef struct {
  PetscInt count;                      /* degrees of freedom of the cell, corner by corner */
  PetscInt corner[EQM_MOST_CELL_DOFS]; /* whose each is */
  PetscReal first[EQM_MOST_CELL_DOFS];
  PetscReal second[EQM_MOST_CELL_DOFS][EQM_MOST_CELL_DOFS]; /* along geodesics */
} EqmCellDerivatives;

PETSC_INTERN void EqmCellDifferentiate(EqmDomain domain, const EqmPlace *place, PetscInt cell,
                                       EqmCellDerivatives *derivatives);

#endif
