/* Where results go: the names that -o lists, each by its suffix. */
#include "store.h"
#include "format/format.h"
#include <string.h>
#include <strings.h>

/* Whether a name ends in `suffix`, in small or capital letters. Not collective. */
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

/* Do something for every name of a comma-separated list. */
typedef PetscErrorCode (*Action)(MPI_Comm comm, const char *file, void *context);

static PetscErrorCode ForEachFile(MPI_Comm comm, const char *files, Action action, void *context)
{
  PetscErrorCode error = 0;
  char **names;
  int count;

  PetscFunctionBegin;
  PetscCall(PetscStrToArray(files, ',', &count, &names));
  for (int k = 0; k < count && !error; k++) error = action(comm, names[k], context);
  PetscCall(PetscStrToArrayDestroy(count, names));
  PetscCall(error);
  if (count == 0) EqmFail(comm, EQM_ERR_USAGE, "-o names no file");
  PetscFunctionReturn(0);
}

/* .h5 holds everything; of the mesh formats, those that rank 0 can write hold the image mesh. */
static PetscErrorCode CheckSuffix(MPI_Comm comm, const char *file, void *context)
{
  const EqmFormat *format = EqmFormatOfSuffix(file);
  char suffixes[256];

  PetscFunctionBegin;
  (void)context;
  if (!EqmHasSuffix(file, ".h5") && !(format && format->write)) {
    EqmFormatListSuffixes(PETSC_TRUE, suffixes, sizeof(suffixes));
    EqmFail(comm, EQM_ERR_USAGE, "cannot write '%s': the suffix says the format, one of %s", file, suffixes);
  }
  PetscFunctionReturn(0);
}

/* A temporary is made and dropped: the only test that knows about quotas, read-only mounts and remote permissions. */
static PetscErrorCode CheckPlace(MPI_Comm comm, const char *file, void *context)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  EqmAtomicFile probe;
  PetscMPIInt rank;

  PetscFunctionBegin;
  (void)context;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    error = EqmAtomicBegin(file, &probe, message, sizeof(message));
    if (!error) EqmAtomicAbort(&probe);
  }
  PetscCall(EqmAgree(comm, error, message));
  PetscFunctionReturn(0);
}

/* Look before a long run whether every name in the comma-separated `files` can be written. Errors: EQM_ERR_USAGE
   (unknown suffix), EQM_ERR_IO (no such directory, no permission). Collective. */
PetscErrorCode EqmMapCheckWritable(MPI_Comm comm, const char *files)
{
  PetscFunctionBegin;
  PetscCall(ForEachFile(comm, files, CheckSuffix, NULL));
  PetscCall(ForEachFile(comm, files, CheckPlace, NULL));
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteOne(MPI_Comm comm, const char *file, void *context)
{
  EqmMap map = (EqmMap)context;

  PetscFunctionBegin;
  (void)comm;
  if (EqmHasSuffix(file, ".h5")) {
    PetscCall(EqmMapWriteResult(map, file));
    PetscCall(EqmMapWriteXdmf(map, file));
  } else {
    PetscCall(EqmMapWriteImage(map, file));
  }
  PetscFunctionReturn(0);
}

/* Write a result to every name in the comma-separated `files`, the format by suffix: .h5 holds everything and gets an
   .xmf beside it; .obj .off .ply .vtu .vtk .msh .mesh .gii .stl hold the mesh with its vertices at their images (z = 0
   for planar maps) and, where the format can, the ratios. Each file appears whole or not at all, and one that was there
   survives a failure. Errors: EQM_ERR_USAGE (unknown suffix; then nothing is written), EQM_ERR_IO. Collective. */
PetscErrorCode EqmMapWrite(EqmMap map, const char *files)
{
  PetscFunctionBegin;
  PetscCall(ForEachFile(map->soup->comm, files, CheckSuffix, NULL));
  PetscCall(ForEachFile(map->soup->comm, files, WriteOne, map));
  PetscFunctionReturn(0);
}
