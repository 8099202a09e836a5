/* Triangles around vertices, in order. */
#include "hierarchy/level.h"

void EqmCornersFill(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells, EqmCorners *corners)
{
  PetscInt *const start = corners->start;

  for (PetscInt v = 0; v < num_vertices + 2; v++) start[v] = 0;
  for (PetscInt k = 0; k < 3 * num_cells; k++) start[cells[k] + 2]++;
  for (PetscInt v = 0; v < num_vertices; v++) start[v + 2] += start[v + 1];
  for (PetscInt k = 0; k < 3 * num_cells; k++) corners->corner[start[cells[k] + 1]++] = k;
}

PetscErrorCode EqmCornersCreate(PetscInt num_vertices, PetscInt num_cells, const PetscInt *cells, EqmCorners *corners)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_vertices + 2, &corners->start));
  PetscCall(PetscMalloc1(3 * num_cells, &corners->corner));
  EqmCornersFill(num_vertices, num_cells, cells, corners);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCornersDestroy(EqmCorners *corners)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(corners->start));
  PetscCall(PetscFree(corners->corner));
  PetscFunctionReturn(0);
}

PetscBool EqmOrderSpokes(PetscInt count, EqmSpoke *spoke, EqmSpoke *scratch, PetscInt *place, PetscBool *closed)
{
  PetscInt first = -1, at, found = 0;

  for (PetscInt k = 0; k < count; k++) place[spoke[k].from] = k + 1;
  /* the one that no other leads to: `cell` of the scratch counts those that do */
  for (PetscInt k = 0; k < count; k++) scratch[k].cell = 0;
  for (PetscInt k = 0; k < count; k++) {
    if (place[spoke[k].to]) scratch[place[spoke[k].to] - 1].cell++;
  }
  for (PetscInt k = 0; k < count && first < 0; k++) {
    if (scratch[k].cell == 0) first = k;
  }
  *closed = (PetscBool)(first < 0);
  for (at = PetscMax(first, 0) + 1; found < count && at > 0; at = place[scratch[found++].to]) {
    scratch[found] = spoke[at - 1];
  }
  for (PetscInt k = 0; k < count; k++) place[spoke[k].from] = 0;
  if (found < count || (*closed && scratch[count - 1].to != scratch[0].from)) return PETSC_FALSE;
  for (PetscInt k = 0; k < count; k++) spoke[k] = scratch[k];
  return PETSC_TRUE;
}
