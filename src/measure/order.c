/* Order statistics of a sample that lies across the ranks, without gathering it. */
#include "measure/order.h"
#include <stdint.h>
#include <string.h>

/* Reals and 64-bit integers in the same order, so that a value can be found by bisection in 64 rounds whatever its
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

/* The difference of two keys may be larger than a signed integer. */
static PetscInt64 MiddleOf(PetscInt64 low, PetscInt64 high)
{
  return low + (PetscInt64)(((unsigned long long)high - (unsigned long long)low) / 2);
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

PetscErrorCode EqmOrderStatistics(MPI_Comm comm, PetscInt n, const PetscReal *sorted, const PetscReal *cumulative,
                                  PetscInt count, const PetscReal *target, PetscReal *value)
{
  PetscInt64 low[EQM_MOST_ORDERS], high[EQM_MOST_ORDERS];
  PetscReal amount[EQM_MOST_ORDERS];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < count; k++) {
    low[k] = KeyOfReal(-PETSC_MAX_REAL);
    high[k] = KeyOfReal(PETSC_MAX_REAL);
  }
  for (PetscInt round = 0; round < 65; round++) {
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt entries = CountUpTo(n, sorted, RealOfKey(MiddleOf(low[k], high[k])));
      amount[k] = !cumulative ? (PetscReal)entries : entries > 0 ? cumulative[entries - 1] : 0.;
    }
    PetscCall(MPIU_Allreduce(MPI_IN_PLACE, amount, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, comm));
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt64 middle = MiddleOf(low[k], high[k]);
      if (low[k] >= high[k]) continue;
      if (amount[k] >= target[k])
        high[k] = middle;
      else
        low[k] = middle + 1;
    }
  }
  for (PetscInt k = 0; k < count; k++) value[k] = RealOfKey(low[k]);
  PetscFunctionReturn(0);
}
