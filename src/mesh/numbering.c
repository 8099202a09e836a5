/* Between the mesh's numbering and the input's. */
#include "mesh/build.h"

typedef enum { TO_INPUT, FROM_INPUT } Direction;

static PetscErrorCode Move(PetscSF sf, PetscInt width, Direction direction, PetscReal *slab, PetscReal *owned)
{
  MPI_Datatype type;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, MPIU_REAL, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  if (direction == TO_INPUT) {
    PetscCall(PetscSFReduceBegin(sf, type, owned, slab, MPI_REPLACE));
    PetscCall(PetscSFReduceEnd(sf, type, owned, slab, MPI_REPLACE));
  } else {
    PetscCall(PetscSFBcastBegin(sf, type, slab, owned, MPI_REPLACE));
    PetscCall(PetscSFBcastEnd(sf, type, slab, owned, MPI_REPLACE));
  }
  PetscCallMPI(MPI_Type_free(&type));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVerticesToInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *owned,
                                      PetscReal *slab)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(Move(sf, width, TO_INPUT, slab, (PetscReal *)owned));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshVerticesFromInput(EqmMesh mesh, EqmSoup soup, PetscInt width, const PetscReal *slab,
                                        PetscReal *local)
{
  PetscSF sf;

  PetscFunctionBegin;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &sf));
  PetscCall(Move(sf, width, FROM_INPUT, (PetscReal *)slab, local));
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
  PetscCall(Move(sf, width, TO_INPUT, slab, (PetscReal *)owned));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}
