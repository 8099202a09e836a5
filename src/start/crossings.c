/* The crossings of the curve between two hemispheres, by their edges. */
#include "start/hemispheres.h"
#include "base/sort.h"
#include <stdlib.h>

static int CompareEdges(const PetscInt a[2], const PetscInt b[2])
{
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

static int CompareCrossings(const void *a, const void *b)
{
  return CompareEdges(((const EqmCrossing *)a)->from, ((const EqmCrossing *)b)->from);
}

EqmCrossing *EqmCutFindCrossing(const EqmCut *cut, PetscInt below, PetscInt above)
{
  const EqmCrossing wanted = {.from = {below, above}};
  return EqmSearch(&wanted, cut->crossing, (size_t)cut->count, sizeof(EqmCrossing), CompareCrossings);
}

void EqmCutSort(EqmCut *cut)
{
  EqmSort(cut->crossing, (size_t)cut->count, sizeof(EqmCrossing), CompareCrossings);
}
