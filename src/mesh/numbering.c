/* Between the mesh's numbering and the input's. */
#include "mesh/build.h"

/* Move `width` reals per leaf of a star forest between its roots (a slab) and its leaves. Collective. */
PetscErrorCode EqmMoveReals(PetscSF sf, PetscInt width, EqmDirection direction, PetscReal *slab, PetscReal *leaves)
{
  MPI_Datatype row;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, MPIU_REAL, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  if (direction == EQM_TO_SLAB) {
    PetscCall(PetscSFReduceBegin(sf, row, leaves, slab, MPI_REPLACE));
    PetscCall(PetscSFReduceEnd(sf, row, leaves, slab, MPI_REPLACE));
  } else {
    PetscCall(PetscSFBcastBegin(sf, row, slab, leaves, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, row, slab, leaves, MPI_REPLACE));
  }
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVerticesToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                      PetscReal *slab)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(EqmMoveReals(sf, width, EQM_TO_SLAB, slab, (PetscReal *)owned));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVerticesFromInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *slab,
                                        PetscReal *local)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(EqmMoveReals(sf, width, EQM_FROM_SLAB, (PetscReal *)slab, local));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(EqmMeshUpdateGhosts(mesh, width, local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshCellsToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned, PetscReal *slab)
{
  PetscLayout layout;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, soup->cell_end - soup->cell_start, soup->num_cells, 1, &layout));
  PetscCall(PetscSFCreate(soup->comm, &sf));
  PetscCall(PetscSFSetGraphLayout(sf, layout, mesh->num_owned_cells, NULL, PETSC_OWN_POINTER, mesh->cell_input));
  PetscCall(EqmMoveReals(sf, width, EQM_TO_SLAB, slab, (PetscReal *)owned));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
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
