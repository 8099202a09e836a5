/* A text file in parts, one for each rank, that begin and end between lines. */
#include "format.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 65536, LOOK_BACK = 3 };

/* Bytes [begin, begin + count) of the file, fewer only at its end; -1: they cannot be read. */
static ssize_t ReadAt(int descriptor, off_t begin, size_t count, char *bytes)
{
  size_t done = 0;

  while (done < count) {
    const ssize_t got = pread(descriptor, bytes + done, PetscMin(count - done, (size_t)1 << 30), begin + (off_t)done);

    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += (size_t)got;
  }
  return (ssize_t)done;
}

/* May the file be cut before c[0]? After the end of a line (\n, \r\n, \r) that no backslash continues. */
static PetscBool IsCut(const char *c)
{
  if (c[-1] == '\n') return c[-2] != '\\' && (c[-2] != '\r' || c[-3] != '\\') ? PETSC_TRUE : PETSC_FALSE;
  return c[-1] == '\r' && c[0] != '\n' && c[-2] != '\\' ? PETSC_TRUE : PETSC_FALSE;
}

/* The first cut at or behind `from` and before `to`; -1: there is none. */
static PetscErrorCode FindCut(int descriptor, PetscInt64 from, PetscInt64 to, PetscInt64 *cut, PetscBool *success)
{
  char *bytes;

  PetscFunctionBegin;
  *cut = -1;
  PetscCall(PetscMalloc1(CHUNK, &bytes));
  for (PetscInt64 at = PetscMax(from - LOOK_BACK, 0); *cut < 0 && at + LOOK_BACK < to; at += CHUNK - LOOK_BACK) {
    const ssize_t got = ReadAt(descriptor, (off_t)at, CHUNK, bytes);

    if (got < 0) *success = PETSC_FALSE;
    if (got <= LOOK_BACK) break;
    for (PetscInt64 k = PetscMax(LOOK_BACK, from - at); k < got && at + k < to && *cut < 0; ++k) {
      if (IsCut(bytes + k)) *cut = at + k;
    }
  }
  PetscCall(PetscFree(bytes));
  PetscFunctionReturn(0);
}

/* Where the parts of this rank and the next begin. A rank that finds no cut in its share of the bytes has no part. */
static PetscErrorCode AgreeOnCuts(MPI_Comm comm, PetscInt64 mine, PetscInt64 length, PetscInt64 bounds[2])
{
  PetscMPIInt size, rank;
  PetscInt64 *cut;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc1(size + 1, &cut));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPIU_INT64, cut, 1, MPIU_INT64, comm));
  cut[0] = 0;
  cut[size] = length;
  for (PetscMPIInt r = size - 1; r > 0; --r) cut[r] = cut[r] < 0 ? cut[r + 1] : cut[r];
  bounds[0] = cut[rank];
  bounds[1] = cut[rank + 1];
  PetscCall(PetscFree(cut));
  PetscFunctionReturn(0);
}

/* Do all ranks see the same file? */
static PetscErrorCode OpenFile(MPI_Comm comm, const char *file, int *descriptor, PetscInt64 *length, PetscBool *success)
{
  PetscInt64 lengths[2];
  struct stat status;

  PetscFunctionBegin;
  *descriptor = open(file, O_RDONLY | O_CLOEXEC);
  *length = -1;
  if (*descriptor >= 0 && !fstat(*descriptor, &status) && S_ISREG(status.st_mode)) *length = status.st_size;
  lengths[0] = *length;
  lengths[1] = -*length;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, lengths, 2, MPIU_INT64, MPI_MIN, comm));
  *success = lengths[0] >= 0 && lengths[0] == -lengths[1] ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFilePartRead(MPI_Comm comm, const char *file, EqmFilePart *part, PetscBool *success)
{
  PetscInt64 length, cut, bounds[2];
  PetscMPIInt size, rank;
  int descriptor;

  PetscFunctionBegin;
  *part = (EqmFilePart){0};
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(OpenFile(comm, file, &descriptor, &length, success));
  if (*success) {
    const PetscInt64 share = length / size + 1;

    PetscCall(FindCut(descriptor, share * rank, PetscMin(share * (rank + 1), length), &cut, success));
    PetscCall(AgreeOnCuts(comm, cut, length, bounds));
    part->before = (size_t)bounds[0];
    part->length = (size_t)(bounds[1] - bounds[0]);
    part->bytes = malloc(part->length + 1);
    if (!part->bytes || ReadAt(descriptor, (off_t)bounds[0], part->length, part->bytes) != (ssize_t)part->length)
      *success = PETSC_FALSE;
    PetscCall(MPIU_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, comm));
  }
  if (descriptor >= 0) close(descriptor);
  PetscFunctionReturn(0);
}
