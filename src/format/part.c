#include "part.h"
#include "input.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 65536, LOOK_BACK = 3, WINDOW = 1 << 20 };

/* Bytes [begin, begin + count) of the file, fewer only at its end; -1: they cannot be read. */
static ssize_t ReadAt(int descriptor, PetscInt64 begin, size_t count, char *bytes)
{
  size_t done = 0;

  while (done < count) {
    const ssize_t got =
        pread(descriptor, bytes + done, PetscMin(count - done, (size_t)1 << 30), (off_t)(begin + (PetscInt64)done));

    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += (size_t)got;
  }
  return (ssize_t)done;
}

/* The file's length, and its first bytes; -1: it is not open, no regular file or cannot be read. */
static PetscErrorCode LookAt(EqmPartFile *file, PetscInt64 *length)
{
  struct stat status;
  ssize_t got = 0;

  PetscFunctionBegin;
  *length = -1;
  PetscCall(PetscMalloc1(EQM_PART_HEAD, &file->head));
  if (file->descriptor < 0 || fstat(file->descriptor, &status) || !S_ISREG(status.st_mode)) PetscFunctionReturn(0);
  if (file->rank == 0) got = ReadAt(file->descriptor, 0, EQM_PART_HEAD, file->head);
  if (got >= 0) *length = status.st_size;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPartFileOpen(MPI_Comm comm, const char *name, EqmPartFile *file, PetscBool *success)
{
  PetscInt64 length, bounds[2];

  PetscFunctionBegin;
  *file = (EqmPartFile){.comm = comm};
  PetscCallMPI(MPI_Comm_rank(comm, &file->rank));
  PetscCallMPI(MPI_Comm_size(comm, &file->size));
  file->descriptor = open(name, O_RDONLY | O_CLOEXEC);
  PetscCall(LookAt(file, &length));
  bounds[0] = length;
  bounds[1] = -length;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, bounds, 2, MPIU_INT64, MPI_MIN, comm));
  *success = bounds[0] >= 0 && bounds[0] == -bounds[1] ? PETSC_TRUE : PETSC_FALSE;
  if (!*success) PetscFunctionReturn(0);
  file->length = length;
  file->head_length = (size_t)PetscMin(length, EQM_PART_HEAD);
  PetscCallMPI(MPI_Bcast(file->head, (PetscMPIInt)file->head_length, MPI_CHAR, 0, comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPartFileClose(EqmPartFile *file)
{
  PetscFunctionBegin;
  if (file->descriptor >= 0) close(file->descriptor);
  PetscCall(PetscFree(file->head));
  PetscFunctionReturn(0);
}

void EqmPartFileShare(const EqmPartFile *file, PetscInt64 total, PetscInt64 *first, PetscInt64 *count)
{
  const PetscInt64 even = total / file->size, rest = total % file->size;

  *first = even * file->rank + PetscMin(file->rank, rest);
  *count = even + (file->rank < rest ? 1 : 0);
}

PetscErrorCode EqmPartFileBytes(const EqmPartFile *file, PetscInt64 before, PetscInt64 length, EqmFilePart *part)
{
  PetscFunctionBegin;
  *part = (EqmFilePart){.before = before};
  if (before < 0 || length < 0 || length > file->length - before) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1((size_t)length + 1, &part->bytes));
  part->length = (size_t)length;
  if (ReadAt(file->descriptor, before, part->length, part->bytes) != (ssize_t)part->length)
    PetscCall(PetscFree(part->bytes));
  PetscFunctionReturn(0);
}

/* May the file be cut before c[0]? After the end of a line (\n, \r\n, \r) that no backslash continues. */
static PetscBool IsCut(const char *c)
{
  if (c[-1] == '\n') return c[-2] != '\\' && (c[-2] != '\r' || c[-3] != '\\') ? PETSC_TRUE : PETSC_FALSE;
  return c[-1] == '\r' && c[0] != '\n' && c[-2] != '\\' ? PETSC_TRUE : PETSC_FALSE;
}

/* Does the line begin with this word? */
static PetscBool BeginsWith(const char *line, const char *end, const char *word)
{
  char unused[8];
  EqmInput in;

  EqmInputOpen(&in, line, (size_t)(end - line), unused, sizeof(unused));
  return EqmReadKeyword(&in, word);
}

/* The first cut at or behind `from` and before `to`; -1: there is none. Cuts are looked for in the first half of each
   stretch of bytes, so that the other half shows how the line begins. */
static PetscErrorCode FindCut(const EqmPartFile *file, PetscInt64 from, PetscInt64 to, const char *word,
                              PetscInt64 *cut, PetscBool *success)
{
  char *bytes;

  PetscFunctionBegin;
  *cut = -1;
  PetscCall(PetscMalloc1(CHUNK, &bytes));
  for (PetscInt64 at = PetscMax(from - LOOK_BACK, 0); *cut < 0 && at + LOOK_BACK < to; at += CHUNK / 2) {
    const ssize_t got = ReadAt(file->descriptor, at, CHUNK, bytes);

    if (got < 0) *success = PETSC_FALSE;
    if (got <= LOOK_BACK) break;
    for (PetscInt64 k = PetscMax(LOOK_BACK, from - at); k < got && at + k < to && *cut < 0; ++k) {
      if (k >= CHUNK / 2 + LOOK_BACK) break;
      if (IsCut(bytes + k) && (!word || BeginsWith(bytes + k, bytes + got, word))) *cut = at + k;
    }
  }
  PetscCall(PetscFree(bytes));
  PetscFunctionReturn(0);
}

/* Where the parts of this rank and the next begin. A rank that finds no cut in its share of the bytes has no part. */
static PetscErrorCode AgreeOnCuts(const EqmPartFile *file, PetscInt64 mine, PetscInt64 begin, PetscInt64 bounds[2])
{
  const PetscMPIInt size = file->size;
  PetscInt64 *cut;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(size + 1, &cut));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPIU_INT64, cut, 1, MPIU_INT64, file->comm));
  cut[0] = begin;
  cut[size] = file->length;
  for (PetscMPIInt r = size - 1; r > 0; --r) cut[r] = cut[r] < 0 ? cut[r + 1] : cut[r];
  bounds[0] = cut[file->rank];
  bounds[1] = cut[file->rank + 1];
  PetscCall(PetscFree(cut));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPartFileLines(const EqmPartFile *file, PetscInt64 begin, const char *word, EqmFilePart *part,
                                PetscBool *success)
{
  const PetscInt64 share = (file->length - begin) / file->size + 1, from = begin + share * file->rank;
  PetscInt64 cut, bounds[2];

  PetscFunctionBegin;
  *success = PETSC_TRUE;
  PetscCall(FindCut(file, from, PetscMin(from + share, file->length), word, &cut, success));
  PetscCall(AgreeOnCuts(file, cut, begin, bounds));
  PetscCall(EqmPartFileBytes(file, bounds[0], bounds[1] - bounds[0], part));
  if (!part->bytes) *success = PETSC_FALSE;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, file->comm));
  PetscFunctionReturn(0);
}

const char *EqmFileWindowAt(EqmFileWindow *window, PetscInt64 offset, size_t count)
{
  const PetscInt64 have = window->begin + (PetscInt64)window->length;

  if (offset < 0 || offset > window->file->length - (PetscInt64)count) return NULL;
  if (offset < window->begin || offset + (PetscInt64)count > have || !window->bytes) {
    ssize_t got;

    if (!window->bytes && PetscMalloc1(WINDOW, &window->bytes)) return NULL;
    got = ReadAt(window->file->descriptor, offset, WINDOW, window->bytes);
    window->begin = offset;
    window->length = (size_t)PetscMax(got, 0);
    if (window->length < count) return NULL;
  }
  return window->bytes + (offset - window->begin);
}

PetscInt64 EqmFileWindowFind(EqmFileWindow *window, PetscInt64 offset, char byte)
{
  for (const char *from; (from = EqmFileWindowAt(window, offset, 1)) != NULL;) {
    const char *const end = window->bytes + window->length, *const found = memchr(from, byte, (size_t)(end - from));

    if (found) return offset + (found - from);
    offset += end - from;
  }
  return -1;
}

PetscErrorCode EqmFileWindowReset(EqmFileWindow *window)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(window->bytes));
  window->length = 0;
  PetscFunctionReturn(0);
}
