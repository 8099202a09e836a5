/* What a map of a surface does to angles. */
#ifndef EQM_ANGLES_H
#define EQM_ANGLES_H

#include <equimap/map.h>

/* Fill angle_error, angle_histogram and quasiconformal of the distortion, and quasi_conformal per cell, from the images
   of local vertices, map->dim each. Collective. */
PETSC_INTERN PetscErrorCode EqmMapMeasureAngles(EqmMap map, EqmMesh mesh, const PetscReal *x);

#endif
