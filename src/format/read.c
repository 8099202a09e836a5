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

/* The row of a format of which each rank can parse a part, -1: none. */
static int RowForParts(const char *name, const EqmPartFile *file)
{
  int row = EqmFormatRowOfContent(file->head, file->head_length);

  if (row < 0) {
    row = EqmFormatRowOfSuffix(name);
    if (row >= 0 && !EqmFormatAt(row)->by_length) return -1;
  }
  return row >= 0 && EqmFormatAt(row)->parse_part ? row : -1;
}

/* On rank 0: a file that may be opened again and again, not a pipe, which can be read once. */
static PetscBool IsRegular(const char *file)
{
  struct stat status;

  return !stat(file, &status) && S_ISREG(status.st_mode) ? PETSC_TRUE : PETSC_FALSE;
}

/* Every rank its part of the file, where format and file allow that; else `soup` stays NULL. Collective. */
static PetscErrorCode ReadParts(MPI_Comm comm, const char *name, EqmSoup *soup)
{
  EqmPartFile file;
  EqmSerialMesh mesh = {0};
  PetscMPIInt rank, size;
  PetscBool success = PETSC_FALSE;
  int row = -1;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (size == 1) PetscFunctionReturn(0);
  if (rank == 0) success = IsRegular(name);
  PetscCallMPI(MPI_Bcast(&success, 1, MPIU_BOOL, 0, comm));
  if (!success) PetscFunctionReturn(0);
  PetscCall(EqmPartFileOpen(comm, name, &file, &success));
  if (success) row = RowForParts(name, &file);
  success = PETSC_FALSE;
  if (row >= 0) PetscCall(EqmFormatAt(row)->parse_part(&file, &mesh, &success));
  PetscCall(EqmPartFileClose(&file));
  if (success) PetscCall(EqmSoupCreateFromParts(comm, &mesh, name, soup));
  PetscFunctionReturn(0);
}

/* EqmSoupRead - read a mesh file; its format is chosen by its content first, then by its name.

   Collective. Files of formats that have a parser of parts, and HDF5 files, are read by all ranks, each its share. One
   rank reads and parses those of the other formats, and what is not as it should be, and deals the mesh to all.
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
