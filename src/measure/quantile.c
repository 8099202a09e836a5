/* Mean, spread and exact quantiles of a sample that lies across the ranks, without gathering it. */
#include "measure/quantile.h"
#include <stdint.h>
#include <string.h>

enum { NUM_QUANTILES = 4 };
static const PetscReal quantile_levels[NUM_QUANTILES] = {.25, .5, .75, .95};

/* Doubles and 64-bit integers in the same order, so that a value can be found by bisection in 64 rounds whatever its
 * size. */
static PetscInt64 KeyOfReal(double x)
{
  PetscInt64 bits;
  memcpy(&bits, &x, sizeof(bits));
  return bits < 0 ? INT64_MIN - bits : bits;
}

static double RealOfKey(PetscInt64 key)
{
  const PetscInt64 bits = key < 0 ? INT64_MIN - key : key;
  double x;
  memcpy(&x, &bits, sizeof(x));
  return x;
}

/* How many entries of the sorted array are not larger than x. */
static PetscInt CountUpTo(PetscInt n, const PetscReal *sorted, PetscReal x)
{
  PetscInt low = 0, high = n;

  while (low < high) {
    const PetscInt middle = low + (high - low) / 2;
    if (sorted[middle] <= x)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The order statistics of the given ranks (from 0) of the union of all ranks' sorted arrays. */
static PetscErrorCode OrderStatistics(MPI_Comm comm, PetscInt n, const PetscReal *sorted, PetscInt count,
                                      const PetscInt64 *rank, PetscReal *value)
{
  PetscInt64 low[2 * NUM_QUANTILES], high[2 * NUM_QUANTILES], below[2 * NUM_QUANTILES];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < count; k++) {
    low[k] = KeyOfReal(-PETSC_MAX_REAL);
    high[k] = KeyOfReal(PETSC_MAX_REAL);
  }
  for (PetscInt round = 0; round < 65; round++) { /* the smallest key that has more than `rank` entries up to it */
    for (PetscInt k = 0; k < count; k++)
      below[k] =
          CountUpTo(n, sorted,
                    RealOfKey(low[k] + (PetscInt64)(((unsigned long long)high[k] - (unsigned long long)low[k]) / 2)));
    PetscCall(MPIU_Allreduce(MPI_IN_PLACE, below, (PetscMPIInt)count, MPIU_INT64, MPI_SUM, comm));
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt64 middle = low[k] + (PetscInt64)(((unsigned long long)high[k] - (unsigned long long)low[k]) / 2);
      if (low[k] >= high[k]) continue;
      if (below[k] > rank[k])
        high[k] = middle;
      else
        low[k] = middle + 1;
    }
  }
  for (PetscInt k = 0; k < count; k++) value[k] = RealOfKey(low[k]);
  PetscFunctionReturn(0);
}

/* Statistics of the union of all ranks' samples; the sample is sorted in place. Quantiles interpolate linearly between
   the neighbouring order statistics. An empty union gives zeros. Collective. */
PetscErrorCode EqmStatisticsOf(MPI_Comm comm, PetscInt n, PetscReal *sample, EqmStatistics *statistics)
{
  PetscInt64 total = n, rank[2 * NUM_QUANTILES];
  PetscReal sum = 0., squares = 0., extreme[2], value[2 * NUM_QUANTILES], quantile[NUM_QUANTILES];

  PetscFunctionBegin;
  *statistics = (EqmStatistics){0};
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, comm));
  if (total == 0) PetscFunctionReturn(0);
  PetscCall(PetscSortReal(n, sample));
  extreme[0] = n ? -sample[0] : -PETSC_MAX_REAL;
  extreme[1] = n ? sample[n - 1] : -PETSC_MAX_REAL;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, extreme, 2, MPIU_REAL, MPIU_MAX, comm));
  for (PetscInt k = 0; k < n; k++) sum += sample[k];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, comm));
  statistics->mean = sum / total;
  for (PetscInt k = 0; k < n; k++) squares += PetscSqr(sample[k] - statistics->mean);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &squares, 1, MPIU_REAL, MPIU_SUM, comm));
  statistics->sd = PetscSqrtReal(squares / total);
  statistics->min = -extreme[0];
  statistics->max = extreme[1];
  for (PetscInt k = 0; k < NUM_QUANTILES; k++) {
    rank[2 * k] = (PetscInt64)PetscFloorReal(quantile_levels[k] * (total - 1));
    rank[2 * k + 1] = PetscMin(rank[2 * k] + 1, total - 1);
  }
  PetscCall(OrderStatistics(comm, n, sample, 2 * NUM_QUANTILES, rank, value));
  for (PetscInt k = 0; k < NUM_QUANTILES; k++) {
    const PetscReal fraction = quantile_levels[k] * (total - 1) - rank[2 * k];
    quantile[k] = value[2 * k] + fraction * (value[2 * k + 1] - value[2 * k]);
  }
  statistics->p25 = quantile[0];
  statistics->p50 = quantile[1];
  statistics->p75 = quantile[2];
  statistics->p95 = quantile[3];
  PetscFunctionReturn(0);
}

/* Mean of the entries of the union of all ranks' samples between two quantiles, these included; the sample is sorted in
   place. An empty union gives zero. Collective. */
PetscErrorCode EqmMeanBetween(MPI_Comm comm, PetscInt n, PetscReal *sample, PetscReal from, PetscReal to,
                              PetscReal *mean)
{
  PetscInt64 total = n, rank[2];
  PetscReal value[2], sum[2] = {0., 0.};

  PetscFunctionBegin;
  *mean = 0.;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, comm));
  if (total == 0) PetscFunctionReturn(0);
  PetscCall(PetscSortReal(n, sample));
  rank[0] = (PetscInt64)PetscFloorReal(from * (total - 1));
  rank[1] = (PetscInt64)PetscCeilReal(to * (total - 1));
  PetscCall(OrderStatistics(comm, n, sample, 2, rank, value));
  for (PetscInt k = 0; k < n; k++) {
    if (sample[k] < value[0] || sample[k] > value[1]) continue;
    sum[0] += sample[k];
    sum[1] += 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, comm));
  *mean = sum[0] / sum[1];
  PetscFunctionReturn(0);
}
