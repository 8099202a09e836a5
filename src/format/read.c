/* EqmSoupRead. */
#include "format.h"
#include "mesh/soup_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

/* On rank 0: the format of a file by its content, else by its name, as a row of the list. */
static PetscErrorCode ChooseFormat(const char *file, const char *bytes, size_t length, int *row, char *error,
                                   size_t error_length)
{
  char suffixes[256];

  *row = EqmFormatRowOfContent(bytes, length);
  if (*row < 0) *row = EqmFormatRowOfSuffix(file);
  if (*row >= 0) return 0;
  EqmFormatListSuffixes(PETSC_FALSE, suffixes, sizeof(suffixes));
  snprintf(error, error_length, "%s: neither content nor name is that of a known mesh format (%s)", file, suffixes);
  return EQM_ERR_IO;
}

/* EqmFormatReadOnRank - read and parse a file on this rank, unless its format is one that all ranks read. Not
   collective. row - of its format in the list. Errors (quiet, reason in `error`): those of EqmSoupRead. */
PetscErrorCode EqmFormatReadOnRank(const char *file, int *row, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  const EqmFormat *format = NULL;
  char *bytes, reason[EQM_MESSAGE_MAX / 2] = "";
  size_t length;
  PetscErrorCode code = EqmFormatLoadBytes(file, &bytes, &length, error, error_length);

  if (!code) code = ChooseFormat(file, bytes, length, row, error, error_length);
  if (!code) format = EqmFormatAt(*row);
  if (!code && format->load) code = format->load(file, &bytes, &length, error, error_length);
  if (!code && !format->read_parallel) {
    code = format->parse(bytes, length, mesh, reason, sizeof(reason));
    if (code == EQM_ERR_IO) snprintf(error, error_length, "cannot read %s as %s: %s", file, format->name, reason);
    if (code == EQM_ERR_MESH) snprintf(error, error_length, "%s: %s", file, reason);
  }
  free(bytes);
  return code;
}

/* On rank 0: the row of a format that all ranks can parse, if name and first bytes of a file both show it; else -1. */
static int RowForParts(const char *file)
{
  enum { HEAD = 65536 };
  const int row = EqmFormatRowOfSuffix(file);
  struct stat status;
  char *head;
  FILE *stream;
  size_t length = 0;
  PetscBool shown;

  if (row < 0 || !EqmFormatAt(row)->parse_part) return -1;
  if (stat(file, &status) || !S_ISREG(status.st_mode)) return -1; /* a pipe can be read once */
  head = malloc(HEAD);
  stream = fopen(file, "rb");
  if (head && stream) length = fread(head, 1, HEAD, stream);
  shown = length && EqmFormatRowOfContent(head, length) == row ? PETSC_TRUE : PETSC_FALSE;
  if (stream) fclose(stream);
  free(head);
  return shown ? row : -1;
}

/* Every rank its part of the file, where format and file allow that; else `soup` stays NULL. Collective. */
static PetscErrorCode ReadParts(MPI_Comm comm, const char *file, EqmSoup *soup)
{
  EqmFilePart part;
  EqmSerialMesh mesh = {0};
  PetscMPIInt rank, size;
  PetscBool success;
  int row = -1;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (size == 1) PetscFunctionReturn(0);
  if (rank == 0) row = RowForParts(file);
  PetscCallMPI(MPI_Bcast(&row, 1, MPI_INT, 0, comm));
  if (row < 0) PetscFunctionReturn(0);
  PetscCall(EqmFilePartRead(comm, file, &part, &success));
  if (success) PetscCall(EqmFormatAt(row)->parse_part(comm, &part, &mesh, &success));
  free(part.bytes);
  if (success) PetscCall(EqmSoupCreateFromParts(comm, &mesh, file, soup));
  PetscFunctionReturn(0);
}

/* EqmSoupRead - read a mesh file; its format is chosen by its content first, then by its name.

   Collective. HDF5 files are read by all ranks, each its slab, and so are OBJ files, each its lines. One rank reads and
   parses those of the other formats, and what is not as it should be, and deals the mesh to all.
   Errors: EQM_ERR_IO (missing, unreadable, not a mesh, truncated; the message names file and line or byte),
   EQM_ERR_MESH (well-formed, but without triangles or tetrahedra, or with other cells). */
PetscErrorCode EqmSoupRead(MPI_Comm comm, const char *file, EqmSoup *soup)
{
  const EqmFormat *format;
  EqmSerialMesh mesh = {0};
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;
  PetscMPIInt rank;
  int row = -1; /* of the list of formats */

  PetscFunctionBegin;
  *soup = NULL;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(ReadParts(comm, file, soup));
  if (*soup) PetscFunctionReturn(0);
  if (rank == 0) code = EqmFormatReadOnRank(file, &row, &mesh, error, sizeof(error));
  PetscCall(EqmAgree(comm, code, error));
  PetscCallMPI(MPI_Bcast(&row, 1, MPI_INT, 0, comm));
  format = EqmFormatAt(row);
  if (format->read_parallel) {
    PetscCall(format->read_parallel(comm, file, soup));
  } else {
    PetscCall(EqmSoupCreateFromRoot(comm, rank == 0 ? &mesh : NULL, file, soup));
  }
  PetscFunctionReturn(0);
}
