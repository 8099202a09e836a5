/* EqmSoupWrite, and the one-rank writer below it. */
#include "format.h"
#include "mesh/soup_private.h"
#include "input.h"
#include "base/nearest.h"

#include <stdio.h>
#include <string.h>

static PetscErrorCode RejectSuffix(const char *file, char *error, size_t length)
{
  const char *const suffix = strrchr(file, '.');
  char suffixes[256], hint[64];

  EqmFormatListSuffixes(PETSC_TRUE, suffixes, sizeof(suffixes));
  PetscCall(EqmDidYouMean(suffix ? suffix : "", suffixes, hint, sizeof(hint)));
  snprintf(error, length, "%s: no mesh format with this suffix can be written; choose one of %s%s", file, suffixes,
           hint);
  return EQM_ERR_USAGE;
}

/* EqmFormatWriteSerial - write a mesh and its fields, the format by suffix, from this rank.

   Not collective. The file is there complete or not at all. Errors (quiet, reason in `error`): EQM_ERR_USAGE (unknown
   suffix, a format that all ranks must write, tetrahedra in a surface format), EQM_ERR_IO. */
PetscErrorCode EqmFormatWriteSerial(const char *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                    PetscInt num_fields, char *error, size_t length)
{
  const EqmFormat *format = EqmFormatOfSuffix(file);
  EqmAtomicFile out;
  char reason[256] = "";
  PetscErrorCode code;

  if (!format || !format->write) return RejectSuffix(file, error, length);
  EqmTry(EqmAtomicOpen(file, &out, error, length));
  code = format->write(&out, mesh, fields, num_fields, reason, sizeof(reason));
  if (!code) return EqmAtomicCommit(&out, error, length);
  snprintf(error, length, "cannot write %s: %s", file, reason);
  EqmAtomicAbort(&out);
  return code;
}

/* Gather on rank 0 and write there. */
static PetscErrorCode WriteFromRoot(EqmSoup soup, const char *file)
{
  EqmSerialMesh mesh;
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(EqmSoupGather(soup, &mesh));
  if (rank == 0) code = EqmFormatWriteSerial(file, &mesh, NULL, 0, error, sizeof(error));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscCall(EqmAgree(soup->comm, code, error));
  PetscFunctionReturn(0);
}

/* EqmSoupWrite - write a mesh, the format by suffix; it is there complete or not at all.

   Collective. Errors: EQM_ERR_USAGE (unknown suffix, tetrahedra in a surface format), EQM_ERR_IO. */
PetscErrorCode EqmSoupWrite(EqmSoup soup, const char *file)
{
  const EqmFormat *format = EqmFormatOfSuffix(file);

  PetscFunctionBegin;
  if (format && format->write_parallel) {
    PetscCall(format->write_parallel(soup, file));
  } else {
    PetscCall(WriteFromRoot(soup, file));
  }
  PetscFunctionReturn(0);
}
