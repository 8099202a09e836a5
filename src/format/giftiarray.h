/* Arrays of GIFTI files, in all their encodings. */
#ifndef EQM_FORMAT_GIFTIARRAY_H
#define EQM_FORMAT_GIFTIARRAY_H

#include "xml.h"

/* One DataArray. */
typedef struct {
  EqmInput *in;
  xmlNodePtr node;
  EqmScalarType type;
  PetscInt64 num_rows, width;
  PetscBool big_endian, column_major;
  char encoding[32];
} EqmGiftiArray;

PETSC_INTERN PetscErrorCode EqmGiftiParseArray(EqmInput *in, xmlNodePtr node, PetscInt64 width, EqmGiftiArray *array);
PETSC_INTERN PetscErrorCode EqmGiftiCheckRoom(const EqmGiftiArray *array);
PETSC_INTERN PetscErrorCode EqmGiftiReadNumbers(const EqmGiftiArray *array, PetscReal *reals, PetscInt64 *integers);

/* Index of entry k of row i among the numbers of the file. */
static inline size_t EqmGiftiIndex(const EqmGiftiArray *array, PetscInt64 i, PetscInt64 k)
{
  return (size_t)(array->column_major ? k * array->num_rows + i : array->width * i + k);
}

#endif
