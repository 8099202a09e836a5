/* Results into the files that -o names, each in the format of its suffix. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/output.h"
#include "store/store.h"
#include "base/nearest.h"
#include "format/format.h"
#include <string.h>

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
  const char *const suffix = strrchr(file, '.');
  char suffixes[256], hint[64];

  PetscFunctionBegin;
  (void)context;
  if (!EqmHasSuffix(file, ".h5") && !(format && EqmFormatIsWritable(format))) {
    EqmFormatListSuffixes(PETSC_TRUE, suffixes, sizeof(suffixes));
    PetscCall(EqmDidYouMean(suffix ? suffix : "", suffixes, hint, sizeof(hint)));
    EqmFail(comm, EQM_ERR_USAGE, "cannot write '%s': the suffix says the format, one of %s%s", file, suffixes, hint);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapCheckWritable(MPI_Comm comm, const char *files)
{
  PetscFunctionBegin;
  PetscCall(ForEachFile(comm, files, CheckSuffix, NULL));
  PetscCall(EqmCheckOutput(comm, NULL, files));
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

PetscErrorCode EqmMapWrite(EqmMap map, const char *files)
{
  PetscFunctionBegin;
  PetscCall(ForEachFile(map->soup->comm, files, CheckSuffix, NULL));
  PetscCall(ForEachFile(map->soup->comm, files, WriteOne, map));
  PetscFunctionReturn(0);
}
