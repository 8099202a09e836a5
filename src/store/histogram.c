/* Histograms as CSV: a header and one row per bin. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
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

PetscErrorCode EqmMapWriteHistogram(EqmMap map, const char *file)
{
  PetscFunctionBegin;
  PetscCall(EqmAtomicPrintFile(map->soup->comm, file, PrintHistogram, map));
  PetscFunctionReturn(0);
}

PetscReal EqmRatioEdge(const EqmDistortion *distortion, PetscInt bin)
{
  const PetscReal reach = distortion->ratio_histogram.reach;

  if (bin == 0) return PetscMin(distortion->ratio.min, 1. - reach);
  if (bin == EQM_NUM_RATIO_BINS) return PetscMax(distortion->ratio.max, 1. + reach);
  return 1. + reach * (2. * (bin - 1) / (EQM_NUM_RATIO_BINS - 2) - 1.);
}

static void PrintRatioHistogram(EqmAtomicFile *file, void *context)
{
  const EqmDistortion *const distortion = &((EqmMap)context)->distortion;

  EqmAtomicPrint(file, "from,to,cells,share\n");
  for (PetscInt k = 0; k < EQM_NUM_RATIO_BINS; k++) {
    const PetscReal edges[2] = {EqmRatioEdge(distortion, k), EqmRatioEdge(distortion, k + 1)};
    EqmAtomicPrintReals(file, 2, edges, ',');
    EqmAtomicPrint(file, ",%" PetscInt64_FMT ",", distortion->ratio_histogram.cells[k]);
    EqmAtomicPrintReals(file, 1, &distortion->ratio_histogram.share[k], ',');
    EqmAtomicPrint(file, "\n");
  }
}

PetscErrorCode EqmMapWriteRatioHistogram(EqmMap map, const char *file)
{
  PetscFunctionBegin;
  PetscCall(EqmAtomicPrintFile(map->soup->comm, file, PrintRatioHistogram, map));
  PetscFunctionReturn(0);
}
