/* EqmSoupRead. */
#include "format.h"

#include <stdio.h>
#include <stdlib.h>

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

/* EqmSoupRead - read a mesh file; its format is chosen by its content first, then by its name.

   Collective. One rank reads and parses and deals the mesh to all; HDF5 files are read by all ranks, each its slab.
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
