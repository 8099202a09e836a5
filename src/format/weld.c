#include "weld.h"

#include <string.h>

static uint64_t Mix(uint64_t h)
{
  h ^= h >> 32;
  h *= UINT64_C(0xd6e8feb86659fd93);
  return h ^ h >> 32;
}

uint64_t EqmWeldHash(const PetscReal *point)
{
  uint64_t hash = 0;

  for (PetscInt k = 0; k < 3; ++k) {
    double value = point[k] == 0.0 ? 0.0 : (double)point[k];
    uint64_t bits;

    memcpy(&bits, &value, sizeof(bits));
    hash = Mix(hash ^ bits) + UINT64_C(0x9e3779b97f4a7c15);
  }
  return hash;
}

static PetscBool SamePoint(const PetscReal *a, const PetscReal *b)
{
  for (PetscInt k = 0; k < 3; ++k) {
    if (a[k] != b[k] && memcmp(&a[k], &b[k], sizeof(a[k]))) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* EqmWeld - number points by their coordinates, in the order of their first appearance. Not collective.

   points - 3 * num_points; afterwards the first 3 * num_distinct are the distinct ones
   number - num_points (at most PETSC_MAX_INT): the distinct point that each one is */
PetscErrorCode EqmWeld(size_t num_points, PetscReal *points, size_t *num_distinct, PetscInt *number)
{
  size_t size = 16, count = 0;
  PetscInt *table; /* open addressing; distinct point + 1, 0 where empty */
  PetscErrorCode code;

  while (size < 2 * num_points) size *= 2;
  code = PetscCalloc1(size, &table);
  if (code) return code;
  for (size_t i = 0; i < num_points; ++i) {
    const PetscReal *point = points + 3 * i;
    size_t slot = (size_t)EqmWeldHash(point) & (size - 1);

    while (table[slot] && !SamePoint(points + 3 * (size_t)(table[slot] - 1), point)) slot = (slot + 1) & (size - 1);
    if (!table[slot]) {
      memmove(points + 3 * count, point, 3 * sizeof(PetscReal));
      table[slot] = (PetscInt)++count;
    }
    number[i] = table[slot] - 1;
  }
  *num_distinct = count;
  return PetscFree(table);
}
