/* Files that a file names, which lie beside it: their contents go behind its own bytes, so that a parser needs no more
   than bytes. */
#ifndef EQM_FORMAT_BESIDE_H
#define EQM_FORMAT_BESIDE_H

#include <equimap/base.h>

PETSC_INTERN PetscErrorCode EqmBesideLoad(const char *file, const char *before_name, char **bytes, size_t *length,
                                          char *error, size_t error_length);
PETSC_INTERN const char *EqmBesideSplit(const char *bytes, size_t length, const char **beside, const char **beside_end);
PETSC_INTERN PetscBool EqmBesideFind(const char *beside, const char *beside_end, const char *name, const char **content,
                                     size_t *length);

#endif
