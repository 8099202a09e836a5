/* Fewer faces. */
#ifndef EQM_THIN_H
#define EQM_THIN_H

#include "picture/picture.h"

/* Faces of the same shape, at most `most`: vertices that lie in one box of a grid are joined into the first of them,
   and faces that have lost a corner are left out; the faces themselves where they are few enough. To be freed with
   EqmFacesReset. Not collective. */
PETSC_INTERN PetscErrorCode EqmThinFaces(const EqmFaces *faces, const PetscReal *points, PetscInt num_points,
                                         PetscInt most, EqmFaces *thinned);

#endif
