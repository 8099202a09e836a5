/* Parts of reading a result file for a report. */
#ifndef EQM_LOAD_H
#define EQM_LOAD_H

#include "picture/picture.h"
#include "h5/h5.h"

/* All rows of an array, which must have `width` entries per row (0: one-dimensional). Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmLoadReals(EqmH5 h5, const char *path, PetscInt64 width, PetscInt *total,
                                         PetscReal **values);
/* The landmarks of a registration, if it has some. Errors: EQM_ERR_IO. */
PETSC_INTERN PetscErrorCode EqmLoadLandmarks(EqmH5 h5, EqmResult *result);

#endif
