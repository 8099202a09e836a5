#include "metadata.h"

#include <string.h>

enum { MAX_METADATA = 1 << 20 }; /* bytes; what is beyond is not kept */

/* EqmMetadataAdd - append a line; tabs and line ends in the value become blanks. Not collective. metadata -
   PetscMalloc'ed or NULL; replaced. Returns PETSc's code where memory runs out. */
PetscErrorCode EqmMetadataAdd(char **metadata, const char *key, const char *value)
{
  const size_t used = *metadata ? strlen(*metadata) : 0, more = strlen(key) + strlen(value) + 3;
  PetscErrorCode code;

  if (!value[0] || used + more > MAX_METADATA) return 0;
  code = PetscRealloc(used + more, metadata);
  if (code) return code;
  snprintf(*metadata + used, more, "%s\t%s\n", key, value);
  for (char *c = *metadata + used + strlen(key) + 1; c[0] && c[1]; ++c) {
    if (*c == '\t' || *c == '\n' || *c == '\r') *c = ' ';
  }
  return 0;
}

/* EqmMetadataGet - the value of a key, cut to `length`; PETSC_FALSE, and an empty value, if it is not there. Not
   collective. */
PetscBool EqmMetadataGet(const char *metadata, const char *key, char *value, size_t length)
{
  const size_t key_length = strlen(key);

  value[0] = '\0';
  for (const char *line = metadata; line && *line; line += strcspn(line, "\n") + 1) {
    if (strncmp(line, key, key_length) || line[key_length] != '\t') continue;
    snprintf(value, length, "%.*s", (int)strcspn(line + key_length + 1, "\n"), line + key_length + 1);
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}
