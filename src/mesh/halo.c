/* Arrays over the local vertices: ghosts from their owners, shares of the cells' weights. */
#include "base/rows.h"
#include "mesh/mesh_private.h"
#include <equimap/mesh.h>

PetscErrorCode EqmMeshUpdateGhosts(EqmMesh mesh, PetscInt width, PetscReal *array)
{
  PetscFunctionBegin;
  if (mesh->size == 1) PetscFunctionReturn(0);
  PetscCall(EqmRowsToLeaves(mesh->halo, width, array, array + width * mesh->num_owned));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVertexWeights(EqmMesh mesh, PetscReal *weights)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) weights[v] = 0.;
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++) {
    const PetscInt v = mesh->cells[k];
    if (v < mesh->num_owned) weights[v] += mesh->weight[k / mesh->cell_size] / mesh->cell_size;
  }
  PetscFunctionReturn(0);
}
