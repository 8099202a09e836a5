/* Ranges along Hilbert's curve through space: as many vertices for each rank, close together, the same ranges however
   the vertices were dealt before. No graph is needed, and no rank sees more than its own vertices. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "base/curve.h"
#include "base/sort.h"
#include <stdlib.h>

PetscErrorCode EqmPartitionAlongCurve(EqmSoup soup, PetscInt *owner_of_slab)
{
  const PetscInt n = soup->vertex_end - soup->vertex_start;
  PetscMPIInt size;
  PetscInt64 *before;
  EqmCurvePlace *place, *cut;
  EqmCube cube;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(PetscMalloc3(n, &place, size - 1, &cut, size - 1, &before));
  PetscCall(EqmCurveBox(soup->comm, n, soup->vertices, &cube));
  for (PetscInt v = 0; v < n; v++)
    place[v] = (EqmCurvePlace){.key = EqmCurveKey(&cube, soup->vertices + 3 * v), .number = soup->vertex_start + v};
  EqmSort(place, (size_t)n, sizeof(*place), EqmCurveCompare);
  for (PetscMPIInt p = 0; p < size - 1; p++) before[p] = (PetscInt64)soup->num_vertices * (p + 1) / size;
  PetscCall(EqmCurveCut(soup->comm, n, place, size - 1, before, cut));
  for (PetscInt k = 0, p = 0; k < n; k++) {
    while (p < size - 1 && EqmCurveCompare(&cut[p], &place[k]) <= 0) p++;
    owner_of_slab[place[k].number - soup->vertex_start] = p;
  }
  PetscCall(PetscFree3(place, cut, before));
  PetscFunctionReturn(0);
}
