/* Ratios weighted by the measure of their cells: what an integral over the surface sees, whatever slivers it has. */
#include "measure/weighted.h"
#include "measure/order.h"

enum { NUM_LEVELS = 5 };
static const PetscReal levels[NUM_LEVELS] = {.05, .25, .5, .75, .95};

/* A cell is an outlier beyond so many weighted standard deviations. All outliers together hold at most 1/100 of the
   measure, by Chebyshev's inequality. */
static const PetscReal outlier_reach = 10.;

static PetscErrorCode ComputeDeviation(MPI_Comm comm, PetscInt n, const PetscReal *ratio, const PetscReal *weight,
                                       PetscReal *total, PetscReal *sd)
{
  PetscReal sum[2] = {0., 0.};

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) {
    sum[0] += weight[c];
    sum[1] += weight[c] * PetscSqr(ratio[c] - 1.);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, comm));
  *total = sum[0];
  *sd = sum[0] > 0. ? PetscSqrtReal(sum[1] / sum[0]) : 0.;
  PetscFunctionReturn(0);
}

static PetscErrorCode ComputeQuantiles(MPI_Comm comm, PetscInt n, const PetscReal *ratio, const PetscReal *weight,
                                       PetscReal total, PetscReal value[NUM_LEVELS])
{
  PetscReal *sorted, *cumulative, target[NUM_LEVELS], sum = 0.;
  PetscInt *order;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &sorted, n, &cumulative, n, &order));
  for (PetscInt c = 0; c < n; c++) order[c] = c;
  PetscCall(PetscSortRealWithPermutation(n, ratio, order));
  for (PetscInt k = 0; k < n; k++) {
    sorted[k] = ratio[order[k]];
    sum += weight[order[k]];
    cumulative[k] = sum;
  }
  for (PetscInt k = 0; k < NUM_LEVELS; k++) target[k] = levels[k] * total;
  PetscCall(EqmOrderStatistics(comm, n, sorted, cumulative, NUM_LEVELS, target, value));
  PetscCall(PetscFree3(sorted, cumulative, order));
  PetscFunctionReturn(0);
}

/* The cells that are far off, and the unweighted standard deviation of the others. */
static PetscErrorCode CountOutliers(MPI_Comm comm, PetscInt n, const PetscReal *ratio, const PetscReal *weight,
                                    PetscReal total, EqmWeightedRatio *weighted)
{
  const PetscReal reach = outlier_reach * weighted->sd;
  PetscReal sum[4] = {0., 0., 0., 0.}, mean; /* outliers, their weight; other cells, sum of r - 1 */

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) {
    const PetscBool far = (PetscBool)(PetscAbsReal(ratio[c] - 1.) > reach);
    sum[0] += far;
    sum[1] += far ? weight[c] : 0.;
    sum[2] += !far;
    sum[3] += far ? 0. : ratio[c] - 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 4, MPIU_REAL, MPIU_SUM, comm));
  weighted->outliers = (PetscInt64)sum[0];
  weighted->outlier_share = sum[1] / total;
  mean = sum[2] > 0. ? sum[3] / sum[2] : 0.;
  sum[0] = 0.;
  for (PetscInt c = 0; c < n; c++)
    if (PetscAbsReal(ratio[c] - 1.) <= reach) sum[0] += PetscSqr(ratio[c] - 1. - mean);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 1, MPIU_REAL, MPIU_SUM, comm));
  weighted->cell_sd_without = sum[2] > 0. ? PetscSqrtReal(sum[0] / sum[2]) : 0.;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmWeightedRatioOf(MPI_Comm comm, PetscInt n, const PetscReal *ratio, const PetscReal *weight,
                                  EqmWeightedRatio *weighted)
{
  PetscReal total, value[NUM_LEVELS];

  PetscFunctionBegin;
  *weighted = (EqmWeightedRatio){0};
  PetscCall(ComputeDeviation(comm, n, ratio, weight, &total, &weighted->sd));
  if (!(total > 0.)) PetscFunctionReturn(0);
  PetscCall(ComputeQuantiles(comm, n, ratio, weight, total, value));
  weighted->p05 = value[0];
  weighted->p25 = value[1];
  weighted->p50 = value[2];
  weighted->p75 = value[3];
  weighted->p95 = value[4];
  PetscCall(CountOutliers(comm, n, ratio, weight, total, weighted));
  PetscFunctionReturn(0);
}

/* 1, 2 or 5 times a power of ten, not smaller than the value. */
static PetscReal RoundUp(PetscReal value)
{
  const PetscReal power = PetscPowReal(10., PetscFloorReal(PetscLog10Real(value)));

  if (value <= power) return power;
  if (value <= 2. * power) return 2. * power;
  return value <= 5. * power ? 5. * power : 10. * power;
}

PetscErrorCode EqmRatioHistogramOf(MPI_Comm comm, PetscInt n, const PetscReal *ratio, const PetscReal *weight,
                                   PetscReal sd, EqmRatioHistogram *histogram)
{
  const PetscInt inner = EQM_NUM_RATIO_BINS - 2;
  PetscReal total = 0.;

  PetscFunctionBegin;
  *histogram = (EqmRatioHistogram){.reach = RoundUp(PetscMax(outlier_reach * sd, 1e-12))};
  for (PetscInt c = 0; c < n; c++) {
    const PetscReal place = (ratio[c] - 1. + histogram->reach) / (2. * histogram->reach) * inner;
    const PetscInt bin = place < 0. ? 0 : place >= inner ? EQM_NUM_RATIO_BINS - 1 : 1 + (PetscInt)place;
    histogram->cells[bin]++;
    histogram->share[bin] += weight[c];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, histogram->cells, EQM_NUM_RATIO_BINS, MPIU_INT64, MPI_SUM, comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, histogram->share, EQM_NUM_RATIO_BINS, MPIU_REAL, MPIU_SUM, comm));
  for (PetscInt k = 0; k < EQM_NUM_RATIO_BINS; k++) total += histogram->share[k];
  for (PetscInt k = 0; k < EQM_NUM_RATIO_BINS && total > 0.; k++) histogram->share[k] /= total;
  PetscFunctionReturn(0);
}
