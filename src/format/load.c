/* A whole file into memory. */
#include "encoding.h"
#include "format.h"
#include "hdf5.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Read to the end of the file, whatever its length was said to be: pipes have none, and files may grow. Mapping the
   file instead would end the program if somebody shortened it meanwhile. */
static int ReadAll(int descriptor, size_t expected, char **bytes, size_t *length)
{
  size_t capacity = expected + 1, count = 0;
  ssize_t got;

  *bytes = malloc(capacity);
  while (*bytes) {
    got = read(descriptor, *bytes + count, PetscMin(capacity - count, (size_t)1 << 30));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    count += (size_t)got;
    *length = count;
    if (got == 0) return 0;
    if (count == capacity) {
      char *larger = realloc(*bytes, capacity *= 2);

      if (!larger) break;
      *bytes = larger;
    }
  }
  return ENOMEM;
}

/* An HDF5 file will be read by all ranks, slab by slab: here its magic bytes are enough. */
static PetscBool LoadHead(int descriptor, char **bytes, size_t *length)
{
  char head[8];

  if (pread(descriptor, head, sizeof(head), 0) != sizeof(head) || !EqmRecogniseHdf5(head, sizeof(head)))
    return PETSC_FALSE;
  *bytes = malloc(sizeof(head));
  if (!*bytes) return PETSC_FALSE;
  memcpy(*bytes, head, sizeof(head));
  *length = sizeof(head);
  return PETSC_TRUE;
}

static int LoadFile(const char *file, char **bytes, size_t *length)
{
  struct stat status;
  int descriptor = open(file, O_RDONLY | O_CLOEXEC), error_number = 0;

  if (descriptor < 0) return errno;
  if (fstat(descriptor, &status)) error_number = errno;
  if (!error_number && S_ISDIR(status.st_mode)) error_number = EISDIR;
  if (!error_number && !LoadHead(descriptor, bytes, length))
    error_number = ReadAll(descriptor, (size_t)PetscMax(status.st_size, 4095), bytes, length);
  close(descriptor);
  return error_number;
}

/* EqmFormatLoadBytes - read a file on this rank, unpacked if gzip has packed it; of an HDF5 file only the magic bytes.
   Not collective. `bytes` is freed with free(), also after a failure. Errors: EQM_ERR_IO (quiet, reason in `error`). */
PetscErrorCode EqmFormatLoadBytes(const char *file, char **bytes, size_t *length, char *error, size_t error_length)
{
  int error_number;

  *bytes = NULL;
  *length = 0;
  error_number = LoadFile(file, bytes, length);
  if (!error_number && EqmIsGzip(*bytes, *length) && !EqmGunzip(bytes, length)) {
    snprintf(error, error_length, "cannot read %s: what gzip has packed is damaged, cut short or too large", file);
    return EQM_ERR_IO;
  }
  if (!error_number && *length) return 0;
  if (error_number) {
    snprintf(error, error_length, "cannot read %s: %s", file, strerror(error_number));
  } else {
    snprintf(error, error_length, "%s is empty", file);
  }
  return EQM_ERR_IO;
}
