#include "prepare/step.h"
#include "mesh/soup_private.h"

PetscErrorCode EqmChangeAssemble(EqmChange *change, EqmVertexGroup *added, EqmCellList *list)
{
  EqmVertexGroup groups[2] = {
      {.num_local = change->soup->vertex_end - change->soup->vertex_start, .position = change->soup->vertices}};

  PetscFunctionBegin;
  if (added) groups[1] = *added;
  for (int g = 0; g < (added ? 2 : 1); g++) PetscCall(EqmVertexGroupPlace(change->soup->comm, &groups[g]));
  PetscCall(EqmSoupAssemble(&change->soup, added ? 2 : 1, groups, list, &change->parent));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmChangeRenumber(EqmChange *change, PetscInt num, const PetscInt *from, const PetscInt *to)
{
  const EqmSoup soup = change->soup;

  PetscFunctionBegin;
  if (num == 0) PetscFunctionReturn(0);
  change->renumbers = PETSC_TRUE;
  PetscCall(PetscMalloc1(soup->vertex_end - soup->vertex_start, &change->vertex));
  for (PetscInt v = soup->vertex_start; v < soup->vertex_end; v++) {
    PetscInt k;
    PetscCall(PetscFindInt(v, num, from, &k));
    change->vertex[v - soup->vertex_start] = k >= 0 ? to[k] : v;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmChangeWeighAdded(EqmChange *change, PetscReal weight)
{
  const EqmSoup soup = change->soup;
  const PetscInt num_cells = soup->cell_end - soup->cell_start;

  PetscFunctionBegin;
  if (weight == 1.) PetscFunctionReturn(0);
  if (!soup->density) {
    PetscCall(PetscMalloc1(num_cells + 1, &soup->density));
    for (PetscInt c = 0; c < num_cells; c++) soup->density[c] = 1.;
  }
  for (PetscInt c = 0; c < num_cells; c++) {
    if (change->parent[c] < 0) soup->density[c] = weight;
  }
  PetscFunctionReturn(0);
}
