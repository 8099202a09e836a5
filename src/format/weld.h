/* Points of equal coordinates become one vertex. */
#ifndef EQM_FORMAT_WELD_H
#define EQM_FORMAT_WELD_H

#include <equimap/base.h>

PETSC_INTERN PetscErrorCode EqmWeld(size_t num_points, PetscReal *points, size_t *num_distinct, PetscInt *number);

#endif
