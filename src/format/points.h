/* Points without a mesh: one row of two or three coordinates per vertex, as CSV or as NumPy's NPY. */
#ifndef EQM_FORMAT_POINTS_H
#define EQM_FORMAT_POINTS_H

#include <equimap/base.h>

typedef struct {
  PetscInt num, dim; /* dim: 2 or 3 */
  PetscReal *values; /* dim * num; PetscMalloc'ed */
} EqmPoints;

PETSC_INTERN PetscBool EqmPointsRecognise(const char *file, const char *bytes, size_t length);
PETSC_INTERN PetscErrorCode EqmPointsParse(const char *bytes, size_t length, EqmPoints *points, char *error,
                                           size_t error_length);

#endif
