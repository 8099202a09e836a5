/* The degrees of freedom of a cell's corners, and what the cell adds to a matrix of all degrees of freedom. */
#ifndef EQM_CELLFRAME_H
#define EQM_CELLFRAME_H

#include <equimap/domain.h>

enum { EQM_MOST_CELL_DOFS = 12 };

/* Corner by corner, as directions in space; in the plane the third coordinate is zero. */
typedef struct {
  PetscInt count;
  PetscInt corner[EQM_MOST_CELL_DOFS]; /* whose each is */
  PetscReal direction[EQM_MOST_CELL_DOFS][3];
  PetscBool is_plain; /* the coordinates of space themselves, corner by corner */
} EqmCellFrame;

/* None of these is collective. */
PETSC_INTERN void EqmCellFrameFind(EqmDomain domain, const EqmPlace *place, PetscInt cell, EqmCellFrame *frame);
/* Add factor g g^T to the cell's matrix, g the gradient by the corners' places. */
PETSC_INTERN void EqmCellFrameAddSquare(const EqmCellFrame *frame, PetscReal factor, PetscReal gradient[4][3],
                                        PetscReal *matrix);
/* Add a Laplacian of the corners in each coordinate of space, times the factor. */
PETSC_INTERN void EqmCellFrameAddLaplacian(const EqmCellFrame *frame, PetscReal factor, PetscReal laplacian[4][4],
                                           PetscReal *matrix);

#endif
