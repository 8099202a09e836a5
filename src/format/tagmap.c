#include "tagmap.h"

/* EqmTagMapReserve - room for `count` tags altogether. Not collective. A map of zero bytes is an empty one. */
PetscErrorCode EqmTagMapReserve(EqmTagMap *map, size_t count)
{
  PetscErrorCode code;

  if (count <= map->capacity) return 0;
  code = PetscRealloc(count * sizeof(*map->tag), &map->tag);
  if (!code) map->capacity = count;
  return code;
}

/* EqmTagMapAdd - the tag (not negative) of the next vertex; room for it must have been reserved. Not collective. */
void EqmTagMapAdd(EqmTagMap *map, PetscInt64 tag)
{
  if (!map->count) {
    map->first = tag;
    map->consecutive = PETSC_TRUE;
  }
  if (tag - map->first != (PetscInt64)map->count) map->consecutive = PETSC_FALSE;
  map->tag[map->count++] = tag;
}

static int CompareTags(const void *left, const void *right, void *unused)
{
  const PetscInt64 a = *(const PetscInt64 *)left, b = *(const PetscInt64 *)right;

  return (a > b) - (a < b);
}

/* EqmTagMapClose - all tags are there; make them findable. Not collective. `repeated` is a tag that two vertices have,
   or -1. */
PetscErrorCode EqmTagMapClose(EqmTagMap *map, PetscInt64 *repeated)
{
  PetscErrorCode code;

  *repeated = -1;
  if (!map->count || map->consecutive) return 0;
  code = PetscMalloc1(map->count, &map->number);
  if (code) return code;
  for (size_t i = 0; i < map->count; ++i) map->number[i] = (PetscInt)i;
  code = PetscTimSortWithArray((PetscInt)map->count, map->tag, sizeof(*map->tag), map->number, sizeof(*map->number),
                               CompareTags, NULL);
  for (size_t i = 1; i < map->count; ++i) {
    if (map->tag[i] == map->tag[i - 1]) *repeated = map->tag[i];
  }
  return code;
}

/* EqmTagMapFind - the vertex of a tag, counted from 0 in file order; -1 if no vertex has it. Not collective. */
PetscInt EqmTagMapFind(const EqmTagMap *map, PetscInt64 tag)
{
  size_t low = 0, high = map->count;

  if (!map->count || tag < 0) return -1;
  if (map->consecutive) {
    return tag >= map->first && tag - map->first < (PetscInt64)map->count ? (PetscInt)(tag - map->first) : -1;
  }
  while (low < high) {
    const size_t middle = low + (high - low) / 2;

    if (map->tag[middle] < tag) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < map->count && map->tag[low] == tag ? map->number[low] : -1;
}

/* EqmTagMapReset - free everything. Not collective. */
PetscErrorCode EqmTagMapReset(EqmTagMap *map)
{
  PetscErrorCode code = PetscFree(map->tag);

  if (!code) code = PetscFree(map->number);
  *map = (EqmTagMap){0};
  return code;
}
