/* Mean, spread and exact quantiles of a sample that lies across the ranks, without gathering it. */
#include "measure/quantile.h"
#include "measure/order.h"

enum { NUM_QUANTILES = 4 };
static const PetscReal quantile_levels[NUM_QUANTILES] = {.25, .5, .75, .95};

PetscErrorCode EqmStatisticsOf(MPI_Comm comm, PetscInt n, PetscReal *sample, EqmStatistics *statistics)
{
  PetscInt64 total = n, rank;
  PetscReal target[2 * NUM_QUANTILES], sum = 0., squares = 0., extreme[2], value[2 * NUM_QUANTILES],
                                       quantile[NUM_QUANTILES];

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
    rank = (PetscInt64)PetscFloorReal(quantile_levels[k] * (total - 1));
    target[2 * k] = (PetscReal)(rank + 1);
    target[2 * k + 1] = (PetscReal)PetscMin(rank + 2, total);
  }
  PetscCall(EqmOrderStatistics(comm, n, sample, NULL, 2 * NUM_QUANTILES, target, value));
  for (PetscInt k = 0; k < NUM_QUANTILES; k++) {
    const PetscReal fraction = quantile_levels[k] * (total - 1) - (target[2 * k] - 1.);
    quantile[k] = value[2 * k] + fraction * (value[2 * k + 1] - value[2 * k]);
  }
  statistics->p25 = quantile[0];
  statistics->p50 = quantile[1];
  statistics->p75 = quantile[2];
  statistics->p95 = quantile[3];
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeanBetween(MPI_Comm comm, PetscInt n, PetscReal *sample, PetscReal from, PetscReal to,
                              PetscReal *mean)
{
  PetscInt64 total = n;
  PetscReal target[2], value[2], sum[2] = {0., 0.};

  PetscFunctionBegin;
  *mean = 0.;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, comm));
  if (total == 0) PetscFunctionReturn(0);
  PetscCall(PetscSortReal(n, sample));
  target[0] = PetscFloorReal(from * (total - 1)) + 1.;
  target[1] = PetscCeilReal(to * (total - 1)) + 1.;
  PetscCall(EqmOrderStatistics(comm, n, sample, NULL, 2, target, value));
  for (PetscInt k = 0; k < n; k++) {
    if (sample[k] < value[0] || sample[k] > value[1]) continue;
    sum[0] += sample[k];
    sum[1] += 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, comm));
  *mean = sum[0] / sum[1];
  PetscFunctionReturn(0);
}
