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
