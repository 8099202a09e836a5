#include "base/curve.h"

enum { BITS = 21, KEY_BITS = 3 * BITS };

int EqmCurveCompare(const void *left, const void *right)
{
  const EqmCurvePlace *const a = left, *const b = right;

  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return a->number < b->number ? -1 : a->number > b->number;
}

/* How far along the curve the cell x of a grid of 2^BITS^3 is (J. Skilling, AIP Conference Proceedings 707, 2004). */
static uint64_t HilbertKey(uint32_t x[3])
{
  uint32_t turned = 0;
  uint64_t key = 0;

  for (uint32_t bit = 1u << (BITS - 1); bit > 1; bit >>= 1) { /* undo the turns of the smaller cubes */
    for (int k = 0; k < 3; k++) {
      const uint32_t swap = x[k] & bit ? 0 : (x[0] ^ x[k]) & (bit - 1);
      if (x[k] & bit) x[0] ^= bit - 1;
      x[0] ^= swap;
      x[k] ^= swap;
    }
  }
  for (int k = 1; k < 3; k++) x[k] ^= x[k - 1];
  for (uint32_t bit = 1u << (BITS - 1); bit > 1; bit >>= 1) turned ^= x[2] & bit ? bit - 1 : 0;
  for (int bit = BITS - 1; bit >= 0; bit--) {
    for (int k = 0; k < 3; k++) key = key << 1 | (((x[k] ^ turned) >> bit) & 1u);
  }
  return key;
}

PetscErrorCode EqmCurveBox(MPI_Comm comm, PetscInt num, const PetscReal *points, EqmCube *cube)
{
  PetscReal bound[6]; /* the least coordinates, and the least of their negatives */

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) bound[k] = PETSC_MAX_REAL;
  for (PetscInt k = 0; k < 3 * num; k++) {
    bound[k % 3] = PetscMin(bound[k % 3], points[k]);
    bound[3 + k % 3] = PetscMin(bound[3 + k % 3], -points[k]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bound, 6, MPIU_REAL, MPIU_MIN, comm));
  cube->width = 0.;
  for (PetscInt k = 0; k < 3; k++) {
    cube->low[k] = bound[k];
    cube->width = PetscMax(cube->width, -bound[3 + k] - bound[k]);
  }
  PetscFunctionReturn(0);
}

uint64_t EqmCurveKey(const EqmCube *cube, const PetscReal *point)
{
  const PetscReal scale = cube->width > 0. ? (PetscReal)((1 << BITS) - 1) / cube->width : 0.;
  uint32_t cell[3];

  for (PetscInt k = 0; k < 3; k++) cell[k] = (uint32_t)((point[k] - cube->low[k]) * scale);
  return HilbertKey(cell);
}

/* How many of the sorted places come before one. */
static PetscInt CountBefore(PetscInt num, const EqmCurvePlace *sorted, EqmCurvePlace limit)
{
  PetscInt low = 0, high = num;

  while (low < high) {
    const PetscInt middle = low + (high - low) / 2;
    if (EqmCurveCompare(&sorted[middle], &limit) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Bit by bit. */
PetscErrorCode EqmCurveCut(MPI_Comm comm, PetscInt num, const EqmCurvePlace *sorted, PetscMPIInt num_cuts,
                           const PetscInt64 *before, EqmCurvePlace *cut)
{
  const int number_bits = (int)(8 * sizeof(PetscInt)) - 1;
  PetscInt64 *count;
  EqmCurvePlace *trial;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num_cuts, &count, num_cuts, &trial));
  for (PetscMPIInt p = 0; p < num_cuts; p++) cut[p] = (EqmCurvePlace){.key = 0, .number = 0};
  for (int bit = KEY_BITS + number_bits - 1; bit >= 0; bit--) {
    for (PetscMPIInt p = 0; p < num_cuts; p++) {
      trial[p] = cut[p];
      if (bit >= number_bits)
        trial[p].key |= (uint64_t)1 << (bit - number_bits);
      else
        trial[p].number |= (PetscInt)1 << bit;
      count[p] = CountBefore(num, sorted, trial[p]);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, num_cuts, MPIU_INT64, MPI_SUM, comm));
    for (PetscMPIInt p = 0; p < num_cuts; p++) {
      if (count[p] <= before[p]) cut[p] = trial[p];
    }
  }
  PetscCall(PetscFree2(count, trial));
  PetscFunctionReturn(0);
}
