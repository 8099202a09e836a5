#define _GNU_SOURCE
#include "beside.h"
#include "format.h"
#include "input.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Behind the file's own bytes: records of a name of NAME_BYTES, the length of the content (8 bytes) and the content; at
   the very end the length of the file's own bytes (8 bytes) and the mark. */
enum { NAME_BYTES = 256, RECORD_BYTES = NAME_BYTES + 8, MARK_BYTES = 8, TAIL_BYTES = 16, MOST_FILES = 16 };
static const char mark[MARK_BYTES] = "\0beside";

static PetscErrorCode Append(char **bytes, size_t *length, const void *more, size_t more_length, char *error,
                             size_t error_length)
{
  char *const larger = realloc(*bytes, *length + more_length + 1);

  if (!larger) {
    snprintf(error, error_length, "too little memory for the files that belong to it");
    return EQM_ERR_IO;
  }
  memcpy(larger + *length, more, more_length);
  *bytes = larger;
  *length += more_length;
  return 0;
}

/* One file as a record. Names with folders are not followed. */
static PetscErrorCode AppendFile(const char *file, const char *name, char **bytes, size_t *length, char *error,
                                 size_t error_length)
{
  const char *const slash = strrchr(file, '/');
  char path[PETSC_MAX_PATH_LEN], record[RECORD_BYTES] = "", *content = NULL;
  size_t content_length = 0;
  uint64_t number;
  PetscErrorCode code;

  if (strchr(name, '/')) {
    snprintf(error, error_length, "%s names the file %s, which does not lie beside it", file, name);
    return EQM_ERR_IO;
  }
  if (snprintf(path, sizeof(path), "%.*s%s", slash ? (int)(slash + 1 - file) : 0, file, name) >= (int)sizeof(path) ||
      strlen(name) >= NAME_BYTES) {
    snprintf(error, error_length, "%s names a file of too long a name", file);
    return EQM_ERR_IO;
  }
  code = EqmFormatLoadBytes(path, &content, &content_length, error, error_length);
  memcpy(record, name, strlen(name));
  number = content_length;
  memcpy(record + NAME_BYTES, &number, sizeof(number));
  if (!code) code = Append(bytes, length, record, sizeof(record), error, error_length);
  if (!code) code = Append(bytes, length, content, content_length, error, error_length);
  free(content);
  return code;
}

/* EqmBesideLoad - append the contents of the files whose names stand, each before a quotation mark, behind
   `before_name` in the bytes of `file`. Not collective. bytes - of malloc; replaced. Nothing is appended where no file
   is named. Errors: EQM_ERR_IO (quiet): a file that cannot be read, or more than 16. */
PetscErrorCode EqmBesideLoad(const char *file, const char *before_name, char **bytes, size_t *length, char *error,
                             size_t error_length)
{
  const uint64_t own = *length;
  const size_t before_length = strlen(before_name);
  char name[MOST_FILES][NAME_BYTES];
  int count = 0;

  for (const char *c = *bytes, *const end = *bytes + *length;
       (c = memmem(c, (size_t)(end - c), before_name, before_length)) != NULL;) {
    const char *const first = c + before_length, *const quote = memchr(first, '"', (size_t)(end - first));
    const size_t name_length = quote ? (size_t)(quote - first) : 0;
    PetscBool known = PETSC_FALSE;

    c = first;
    if (!name_length || name_length >= NAME_BYTES) continue;
    for (int i = 0; i < count; ++i) {
      if (!strncmp(name[i], first, name_length) && !name[i][name_length]) known = PETSC_TRUE;
    }
    if (known) continue;
    if (count == MOST_FILES) {
      snprintf(error, error_length, "%s names more than %d files", file, MOST_FILES);
      return EQM_ERR_IO;
    }
    snprintf(name[count++], NAME_BYTES, "%.*s", (int)name_length, first);
  }
  if (!count) return 0;
  for (int i = 0; i < count; ++i) EqmTry(AppendFile(file, name[i], bytes, length, error, error_length));
  EqmTry(Append(bytes, length, &own, sizeof(own), error, error_length));
  return Append(bytes, length, mark, MARK_BYTES, error, error_length);
}

/* EqmBesideSplit - the end of the file's own bytes, and what EqmBesideLoad put behind them (NULL: nothing). Not
   collective. */
const char *EqmBesideSplit(const char *bytes, size_t length, const char **beside, const char **beside_end)
{
  uint64_t own;

  *beside = *beside_end = NULL;
  if (length < TAIL_BYTES || memcmp(bytes + length - MARK_BYTES, mark, MARK_BYTES)) return bytes + length;
  memcpy(&own, bytes + length - TAIL_BYTES, sizeof(own));
  if (own > length - TAIL_BYTES) return bytes + length;
  *beside = bytes + own;
  *beside_end = bytes + length - TAIL_BYTES;
  return *beside;
}

/* EqmBesideFind - the content of the file of this name. Not collective. */
PetscBool EqmBesideFind(const char *beside, const char *beside_end, const char *name, const char **content,
                        size_t *length)
{
  while (beside && beside_end - beside >= RECORD_BYTES) {
    uint64_t number;

    memcpy(&number, beside + NAME_BYTES, sizeof(number));
    *content = beside + RECORD_BYTES;
    if (number > (uint64_t)(beside_end - *content)) return PETSC_FALSE;
    *length = (size_t)number;
    if (!strncmp(beside, name, NAME_BYTES)) return PETSC_TRUE;
    beside = *content + number;
  }
  return PETSC_FALSE;
}
