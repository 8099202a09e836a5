/* Base64 text and zlib streams, as XML mesh formats use them; files packed by gzip. */
#ifndef EQM_FORMAT_ENCODING_H
#define EQM_FORMAT_ENCODING_H

#include "base/atomicfile.h"

/* Bytes that become base64 text in a file as they come. */
typedef struct {
  EqmAtomicFile *file;
  size_t num_kept; /* bytes that wait for others to make a group of three */
  char kept[3 * 1024];
} EqmBase64Writer;

PETSC_INTERN size_t EqmBase64Length(size_t num_bytes);
PETSC_INTERN size_t EqmBase64Decode(const char *text, size_t length, char *bytes, size_t max_bytes);
PETSC_INTERN void EqmBase64Open(EqmBase64Writer *writer, EqmAtomicFile *file);
PETSC_INTERN void EqmBase64Write(EqmBase64Writer *writer, const void *bytes, size_t num_bytes);
PETSC_INTERN void EqmBase64Close(EqmBase64Writer *writer);
PETSC_INTERN PetscBool EqmInflate(const char *packed, size_t length, char *bytes, size_t num_bytes);
PETSC_INTERN PetscBool EqmIsGzip(const char *bytes, size_t length);
PETSC_INTERN PetscBool EqmGunzip(char **bytes, size_t *length);
PETSC_INTERN PetscBool EqmInflatePlausible(size_t packed_length, size_t num_bytes);

#endif
