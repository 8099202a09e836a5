/* Measures of an image that another program made. */
#ifndef EQM_FOREIGN_H
#define EQM_FOREIGN_H

#include <equimap/map.h>
#include "measure/recognise.h"

PETSC_INTERN PetscErrorCode EqmMapMeasureForeign(EqmMap map, EqmMesh mesh, PetscReal *x, EqmImagePlacement *placement,
                                                 PetscBool *repeats);

#endif
