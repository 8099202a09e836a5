/* Ranges along Hilbert's curve through space: as many vertices for each rank, close together, the same ranges however
   the vertices were dealt before. No graph is needed, and no rank sees more than its own vertices. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include <stdint.h>
#include <stdlib.h>

enum { BITS = 21, KEY_BITS = 3 * BITS };

/* Places along the curve; where these are the same, the number in the input decides. */
typedef struct {
  uint64_t key;
  PetscInt input;
} Place;

static int Compare(const void *left, const void *right)
{
  const Place *const a = left, *const b = right;

  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return a->input < b->input ? -1 : a->input > b->input;
}

/* How far along the curve the cell x of a grid of 2^BITS^3 is (J. Skilling, AIP Conference Proceedings 707, 2004). */
static uint64_t HilbertKey(const uint32_t cell[3])
{
  uint32_t x[3] = {cell[0], cell[1], cell[2]}, turned = 0;
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

/* The places of this rank's slab of vertices. Collective. */
static PetscErrorCode MakePlaces(EqmSoup soup, Place *place)
{
  const PetscInt n = soup->vertex_end - soup->vertex_start;
  PetscReal bound[6], width = 0., scale; /* the least coordinates, and the least of their negatives */

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) bound[k] = PETSC_MAX_REAL;
  for (PetscInt k = 0; k < 3 * n; k++) {
    bound[k % 3] = PetscMin(bound[k % 3], soup->vertices[k]);
    bound[3 + k % 3] = PetscMin(bound[3 + k % 3], -soup->vertices[k]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bound, 6, MPIU_REAL, MPIU_MIN, soup->comm));
  for (PetscInt k = 0; k < 3; k++) width = PetscMax(width, -bound[3 + k] - bound[k]);
  scale = width > 0. ? (PetscReal)((1 << BITS) - 1) / width : 0.;
  for (PetscInt v = 0; v < n; v++) {
    uint32_t cell[3];
    for (PetscInt k = 0; k < 3; k++) cell[k] = (uint32_t)((soup->vertices[3 * v + k] - bound[k]) * scale);
    place[v] = (Place){.key = HilbertKey(cell), .input = soup->vertex_start + v};
  }
  PetscFunctionReturn(0);
}

/* How many of the sorted places come before one. */
static PetscInt CountBefore(PetscInt n, const Place *sorted, Place limit)
{
  PetscInt low = 0, high = n;

  while (low < high) {
    const PetscInt middle = low + (high - low) / 2;
    if (Compare(&sorted[middle], &limit) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Where the ranges of ranks 1, 2, ... begin: bit by bit the last place with no more vertices before it than the ranks
   before shall have. Collective. */
static PetscErrorCode FindCuts(EqmSoup soup, PetscMPIInt size, PetscInt n, const Place *sorted, Place *cut)
{
  const int input_bits = (int)(8 * sizeof(PetscInt)) - 1;
  PetscInt64 *before;
  Place *trial;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(size - 1, &before, size - 1, &trial));
  for (PetscMPIInt p = 0; p < size - 1; p++) cut[p] = (Place){.key = 0, .input = 0};
  for (int bit = KEY_BITS + input_bits - 1; bit >= 0; bit--) {
    for (PetscMPIInt p = 0; p < size - 1; p++) {
      trial[p] = cut[p];
      if (bit >= input_bits)
        trial[p].key |= (uint64_t)1 << (bit - input_bits);
      else
        trial[p].input |= (PetscInt)1 << bit;
      before[p] = CountBefore(n, sorted, trial[p]);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, before, size - 1, MPIU_INT64, MPI_SUM, soup->comm));
    for (PetscMPIInt p = 0; p < size - 1; p++) {
      if (before[p] <= (PetscInt64)soup->num_vertices * (p + 1) / size) cut[p] = trial[p];
    }
  }
  PetscCall(PetscFree2(before, trial));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPartitionAlongCurve(EqmSoup soup, PetscInt *owner_of_slab)
{
  const PetscInt n = soup->vertex_end - soup->vertex_start;
  PetscMPIInt size;
  Place *place, *cut;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(PetscMalloc2(n, &place, size - 1, &cut));
  PetscCall(MakePlaces(soup, place));
  qsort(place, (size_t)n, sizeof(*place), Compare);
  PetscCall(FindCuts(soup, size, n, place, cut));
  for (PetscInt k = 0, p = 0; k < n; k++) {
    while (p < size - 1 && Compare(&cut[p], &place[k]) <= 0) p++;
    owner_of_slab[place[k].input - soup->vertex_start] = p;
  }
  PetscCall(PetscFree2(place, cut));
  PetscFunctionReturn(0);
}
