/* Arrays of VTK's XML files, in all their encodings. */
#ifndef EQM_FORMAT_VTUARRAY_H
#define EQM_FORMAT_VTUARRAY_H

#include "part.h"
#include "xml.h"

/* What the file says about all its arrays. */
typedef struct {
  EqmInput *in;
  const EqmPartFile *file;     /* every rank reads its share of the rows; NULL: one rank reads all, from memory */
  PetscInt64 appended_in_file; /* with `file`: where appended data begins; 0: there is none */
  size_t file_bytes;           /* the length of the whole file */
  PetscBool big_endian, compressed;
  EqmScalarType header; /* type of the lengths before the data */
  const char *appended; /* the appended data behind the underscore, or NULL */
  size_t appended_length;
  PetscBool appended_base64;
} EqmVtuEncoding;

/* Some of an array's numbers: `count` of `total`, from `first` on. */
typedef struct {
  PetscInt64 total, first, count;
} EqmVtuRange;

PETSC_INTERN EqmVtuRange EqmVtuShare(const EqmVtuEncoding *encoding, PetscInt64 num_rows, PetscInt64 width);
PETSC_INTERN PetscErrorCode EqmVtuReadReals(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range,
                                            PetscReal *values);
PETSC_INTERN PetscErrorCode EqmVtuReadIntegers(const EqmVtuEncoding *encoding, xmlNodePtr node, EqmVtuRange range,
                                               PetscInt64 **values);
PETSC_INTERN PetscErrorCode EqmVtuCheckRoom(const EqmVtuEncoding *encoding, xmlNodePtr node, PetscInt64 count);
/* EqmVtuLoadRange - the bytes of numbers of an array that is in the file, `size` each; PetscFree them, also after a
   failure. The text of its node is "@BEGIN LENGTH" where it is not appended: where it is in the file. Not collective.
   range.total has been checked: the file can hold so many. Errors: EQM_ERR_IO (quiet, without a sentence) for what is
   damaged or text of numbers. */
PETSC_INTERN PetscErrorCode EqmVtuLoadRange(const EqmVtuEncoding *encoding, xmlNodePtr node, size_t size,
                                            EqmVtuRange range, char **bytes);

#endif
