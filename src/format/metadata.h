/* What a file says beside its mesh: lines "key<tab>value", kept where a mesh goes on into another file. */
#ifndef EQM_FORMAT_METADATA_H
#define EQM_FORMAT_METADATA_H

#include <equimap/base.h>

/* The key of a group's name, with its number. */
#define EQM_GROUP_KEY "group %lld"

PETSC_INTERN PetscErrorCode EqmMetadataAdd(char **metadata, const char *key, const char *value);
PETSC_INTERN PetscBool EqmMetadataGet(const char *metadata, const char *key, char *value, size_t length);

#endif
