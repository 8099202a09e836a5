/* The histogram of angle errors as CSV: a header and one row per bin. */
#include "store.h"
#include "base/atomicfile.h"

static PetscErrorCode WriteOnRoot(EqmMap map, const char *name, char *message, size_t length)
{
  const PetscReal width = 180. / EQM_NUM_ANGLE_BINS;
  EqmAtomicFile file;
  PetscErrorCode error = EqmAtomicOpen(name, &file, message, length);

  if (error) return error;
  EqmAtomicPrint(&file, "from,to,corners\n");
  for (PetscInt k = 0; k < EQM_NUM_ANGLE_BINS; k++) {
    const PetscReal edges[2] = {k * width, (k + 1) * width};
    EqmAtomicPrintReals(&file, 2, edges, ',');
    EqmAtomicPrint(&file, ",%" PetscInt64_FMT "\n", map->distortion.angle_histogram[k]);
  }
  return EqmAtomicCommit(&file, message, length);
}

/* Write the histogram as CSV, whole or not at all. Errors: EQM_ERR_IO on all ranks. Collective; rank 0 writes. */
PetscErrorCode EqmMapWriteHistogram(EqmMap map, const char *file)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(map->soup->comm, &rank));
  if (rank == 0) error = WriteOnRoot(map, file, message, sizeof(message));
  PetscCall(EqmAgree(map->soup->comm, error, message));
  PetscFunctionReturn(0);
}
