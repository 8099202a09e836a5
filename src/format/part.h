/* A mesh file that all ranks have open, of which each reads a part: lines of text, or bytes whose place is known. */
#ifndef EQM_FORMAT_PART_H
#define EQM_FORMAT_PART_H

#include <equimap/soup.h>

enum { EQM_PART_HEAD = 65536 };

typedef struct {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  int descriptor;
  PetscInt64 length;  /* bytes of the file */
  size_t head_length; /* the first bytes, at most EQM_PART_HEAD, the same on every rank */
  char *head;
} EqmPartFile;

/* A stretch of the file in memory. */
typedef struct {
  char *bytes;
  size_t length;
  PetscInt64 before; /* bytes of the file before it */
} EqmFilePart;

/* A file that is looked at here and there, through a buffer of a fixed size. Zero but for `file` at the beginning. */
typedef struct {
  const EqmPartFile *file;
  PetscInt64 begin;
  size_t length;
  char *bytes;
} EqmFileWindow;

/* EqmPartFileOpen - open a file on all ranks. `success` is false on every rank if it is no regular file, cannot be read
   or is not the same everywhere. EqmPartFileClose must follow. Collective. */
PETSC_INTERN PetscErrorCode EqmPartFileOpen(MPI_Comm comm, const char *name, EqmPartFile *file, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmPartFileClose(EqmPartFile *file);
/* EqmPartFileLines - this rank's lines from byte `begin` on. word - NULL, or the first word of the lines that a part
   may begin with, in upper or lower case. success - false on every rank if one of them cannot read its part, which is
   to be freed with PetscFree in any case. Collective. */
PETSC_INTERN PetscErrorCode EqmPartFileLines(const EqmPartFile *file, PetscInt64 begin, const char *word,
                                             EqmFilePart *part, PetscBool *success);
/* EqmPartFileBytes - `length` bytes from `before` on, where the file has them all and they can be read; NULL elsewhere.
   To be freed with PetscFree. Not collective. */
PETSC_INTERN PetscErrorCode EqmPartFileBytes(const EqmPartFile *file, PetscInt64 before, PetscInt64 length,
                                             EqmFilePart *part);
/* EqmPartFileShare - which of `total` rows are this rank's: `count` from `first` on. Not collective. */
PETSC_INTERN void EqmPartFileShare(const EqmPartFile *file, PetscInt64 total, PetscInt64 *first, PetscInt64 *count);
/* EqmFileWindowAt - `count` bytes of the file, or NULL if it ends before or cannot be read. The pointer is good until
   the next call. count - at most EQM_PART_HEAD. Not collective. */
PETSC_INTERN const char *EqmFileWindowAt(EqmFileWindow *window, PetscInt64 offset, size_t count);
/* EqmFileWindowFind - where the byte is next, from `offset` on; -1: nowhere. Not collective. */
PETSC_INTERN PetscInt64 EqmFileWindowFind(EqmFileWindow *window, PetscInt64 offset, char byte);
PETSC_INTERN PetscErrorCode EqmFileWindowReset(EqmFileWindow *window);

#endif
