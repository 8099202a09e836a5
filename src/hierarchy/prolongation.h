#ifndef EQM_PROLONGATION_H
#define EQM_PROLONGATION_H

#include <petscmat.h>
#include "hierarchy/levelmap.h"

/* The matrix that takes motions of a coarser level's vertices to those of the next finer one's, in the directions that
   each has (EqmMotionFrame), three coarse vertices at most for each fine one. They are taken in the image, where a fine
   vertex is their mean with positive weights: affine motions of the plane and rotations of the sphere come out exact.
   The places of the coarser map must be those of the finer one. Not collective. */
PETSC_INTERN PetscErrorCode EqmProlongationCreate(const EqmLevelMap *finer, const EqmLevelMap *coarser,
                                                  const PetscInt *first_finer, const PetscInt *first_coarser,
                                                  Mat *prolongation);

#endif
