/* The histogram of angle errors as CSV: a header and one row per bin. */
#include "store/map_private.h"
#include "store/store.h"
#include "base/atomicfile.h"

static void PrintHistogram(EqmAtomicFile *file, void *context)
{
  const EqmMap map = context;
  const PetscReal width = 180. / EQM_NUM_ANGLE_BINS;

  EqmAtomicPrint(file, "from,to,corners\n");
  for (PetscInt k = 0; k < EQM_NUM_ANGLE_BINS; k++) {
    const PetscReal edges[2] = {k * width, (k + 1) * width};
    EqmAtomicPrintReals(file, 2, edges, ',');
    EqmAtomicPrint(file, ",%" PetscInt64_FMT "\n", map->distortion.angle_histogram[k]);
  }
}

/* Write the histogram as CSV, whole or not at all. Errors: EQM_ERR_IO on all ranks. Collective; rank 0 writes. */
PetscErrorCode EqmMapWriteHistogram(EqmMap map, const char *file)
{
  PetscFunctionBegin;
  PetscCall(EqmAtomicPrintFile(map->soup->comm, file, PrintHistogram, map));
  PetscFunctionReturn(0);
}
