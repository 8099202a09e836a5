/* Between the mesh's numbering and the input's. */
#include "mesh/build.h"
#include "mesh/gather.h"
#include "mesh/mesh_private.h"
#include "base/rows.h"

PetscErrorCode EqmMeshVerticesToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                      PetscReal *slab)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(EqmRowsToRoots(sf, width, owned, slab));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVerticesFromInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *slab,
                                        PetscReal *local)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(EqmRowsToLeaves(sf, width, slab, local));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(EqmMeshUpdateGhosts(mesh, width, local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshCellsToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned, PetscReal *slab)
{
  PetscFunctionBegin;
  PetscCall(EqmPutRows(soup->comm, soup->cell_end - soup->cell_start, mesh->num_owned_cells, mesh->cell_input,
                       MPIU_REAL, width, owned, slab));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshFindVertices(EqmMesh mesh, PetscInt num, const PetscInt *input, PetscInt *local)
{
  PetscInt *sorted, *vertex;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_owned, &sorted, mesh->num_owned, &vertex));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    sorted[v] = mesh->vertex_input[v];
    vertex[v] = v;
  }
  PetscCall(PetscSortIntWithArray(mesh->num_owned, sorted, vertex));
  for (PetscInt i = 0; i < num; i++) {
    PetscInt at;
    PetscCall(PetscFindInt(input[i], mesh->num_owned, sorted, &at));
    local[i] = at < 0 ? -1 : vertex[at];
  }
  PetscCall(PetscFree2(sorted, vertex));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshGatherVertices(EqmMesh mesh, PetscInt num, const PetscInt *vertices, PetscInt width,
                                     const PetscReal *values, PetscReal *gathered, PetscInt *missing)
{
  const PetscInt stride = width + 1; /* the last entry counts the owners: 1, or 0 for a vertex of no cell */
  PetscReal *entries;
  PetscInt *local;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(stride * num, &count));
  PetscCall(PetscCalloc1(stride * num, &entries));
  PetscCall(PetscMalloc1(num, &local));
  PetscCall(EqmMeshFindVertices(mesh, num, vertices, local));
  for (PetscInt i = 0; i < num; i++) {
    if (local[i] < 0) continue;
    PetscCall(PetscArraycpy(entries + stride * i, values + width * local[i], width));
    entries[stride * i + width] = 1.;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, entries, count, MPIU_REAL, MPIU_SUM, mesh->comm));
  if (missing) *missing = -1;
  for (PetscInt i = num - 1; i >= 0; i--) {
    PetscCall(PetscArraycpy(gathered + width * i, entries + stride * i, width));
    if (missing && entries[stride * i + width] == 0.) *missing = i;
  }
  PetscCall(PetscFree(local));
  PetscCall(PetscFree(entries));
  PetscFunctionReturn(0);
}

/* Input numbers of all local vertices. */
static PetscErrorCode InputNumbers(EqmMesh mesh, PetscInt *input)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(input, mesh->vertex_input, mesh->num_owned));
  PetscCall(PetscSFBcastBegin(mesh->halo, MPIU_INT, input, input + mesh->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, input, input + mesh->num_owned, MPI_REPLACE));
  PetscFunctionReturn(0);
}

/* Count those vertices that are leaves on some rank in input order, which no distribution changes: even shares of the
   input's numbers are marked, counted and read back. leaf - local vertices, number - what they get. Collective.
 */
PetscErrorCode EqmMeshNumberInOrder(EqmMesh mesh, PetscInt num_leaves, const PetscInt *leaf, PetscInt *number)
{
  PetscInt *input, *root, *count_of, count = 0, first = 0;
  PetscLayout layout;
  PetscSF directory;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local, &input, num_leaves, &root));
  PetscCall(InputNumbers(mesh, input));
  for (PetscInt k = 0; k < num_leaves; k++) {
    root[k] = input[leaf[k]];
    number[k] = 1;
  }
  PetscCall(PetscLayoutCreateFromSizes(mesh->comm, PETSC_DECIDE, mesh->soup_vertices, 1, &layout));
  PetscCall(PetscSFCreate(mesh->comm, &directory));
  PetscCall(PetscSFSetGraphLayout(directory, layout, num_leaves, NULL, PETSC_OWN_POINTER, root));
  PetscCall(PetscCalloc1(layout->n, &count_of));
  PetscCall(PetscSFReduceBegin(directory, MPIU_INT, number, count_of, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(directory, MPIU_INT, number, count_of, MPI_REPLACE));
  for (PetscInt i = 0; i < layout->n; i++) count += count_of[i];
  PetscCallMPI(MPI_Exscan(&count, &first, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (mesh->rank == 0) first = 0;
  for (PetscInt i = 0; i < layout->n; i++) {
    if (count_of[i]) count_of[i] = first++;
  }
  PetscCall(PetscSFBcastBegin(directory, MPIU_INT, count_of, number, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(directory, MPIU_INT, count_of, number, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&directory));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(PetscFree(count_of));
  PetscCall(PetscFree2(input, root));
  PetscFunctionReturn(0);
}
