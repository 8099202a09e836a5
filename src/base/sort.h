/* Sorting and searching arrays that may be empty: the C library's functions want an array even then. */
#ifndef EQM_SORT_H
#define EQM_SORT_H

#include <stdlib.h>

/* qsort; `first` may be NULL where `count` is 0, as PetscMalloc leaves it. Not collective. */
static inline void EqmSort(void *first, size_t count, size_t size, int (*compare)(const void *, const void *))
{
  if (count) qsort(first, count, size, compare);
}

/* bsearch likewise. Not collective. */
static inline void *EqmSearch(const void *key, const void *first, size_t count, size_t size,
                              int (*compare)(const void *, const void *))
{
  return count ? bsearch(key, first, count, size, compare) : NULL;
}

#endif
