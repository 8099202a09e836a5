/* Arrays of VTK's XML files, in all their encodings. */
#ifndef EQM_FORMAT_VTUARRAY_H
#define EQM_FORMAT_VTUARRAY_H

#include "xml.h"

/* What the file says about all its arrays. */
typedef struct {
  EqmInput *in;
  PetscBool big_endian, compressed;
  EqmScalarType header; /* type of the lengths before the data */
  const char *appended; /* the appended data behind the underscore, or NULL */
  size_t appended_length;
  PetscBool appended_base64;
} EqmVtuEncoding;

PETSC_INTERN PetscErrorCode EqmVtuReadReals(const EqmVtuEncoding *encoding, xmlNodePtr node, PetscInt64 count,
                                            PetscReal *values);
PETSC_INTERN PetscErrorCode EqmVtuReadIntegers(const EqmVtuEncoding *encoding, xmlNodePtr node, PetscInt64 count,
                                               PetscInt64 **values);
PETSC_INTERN PetscErrorCode EqmVtuCheckRoom(const EqmVtuEncoding *encoding, xmlNodePtr node, PetscInt64 count);

#endif
