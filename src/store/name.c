/* Names of files. */
#include "store/store.h"
#include <string.h>
#include <strings.h>

PetscBool EqmHasSuffix(const char *name, const char *suffix)
{
  const size_t length = strlen(name), tail = strlen(suffix);

  return (PetscBool)(length > tail && !strcasecmp(name + length - tail, suffix));
}

PetscErrorCode EqmNameBeside(const char *file, const char *suffix, char *name, size_t length)
{
  const size_t whole = strlen(file), end = EqmHasSuffix(file, ".h5") ? strlen(".h5") : 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, length, "%.*s%s", (int)(whole - end), file, suffix));
  PetscFunctionReturn(0);
}
