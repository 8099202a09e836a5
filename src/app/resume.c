/* The mesh of a run that goes on: the one that is named, or the copy that lies beside the checkpoint. */
#include "app.h"
#include "base/lookup.h"
#include "store/keptmesh.h"

/* EqmInputChoose - say in `input` which mesh to read: the one that is named, or, on a restart for which it is gone or
   not named, the copy beside the checkpoint; likewise the density.

   Collective on PETSC_COMM_WORLD. named - the command line's, or NULL; restart - the checkpoint, or NULL; input - its
   density has been filled in. Errors: those of EqmKeptMeshFind. */
PetscErrorCode EqmInputChoose(const char *named, const char *restart, EqmInputOptions *input)
{
  PetscBool mesh_there, density_there, has_density;

  PetscFunctionBegin;
  input->resumed = (PetscBool)(restart != NULL);
  PetscCall(PetscStrncpy(input->mesh, named ? named : "", sizeof(input->mesh)));
  PetscCall(EqmFileIsThere(PETSC_COMM_WORLD, named, &mesh_there));
  PetscCall(EqmFileIsThere(PETSC_COMM_WORLD, input->density, &density_there));
  if (!restart || (mesh_there && (density_there || !input->density))) PetscFunctionReturn(0);
  PetscCall(EqmKeptMeshFind(PETSC_COMM_WORLD, restart, input->copy, sizeof(input->copy), &has_density));
  if (!density_there && has_density) input->density = input->copy;
  if (mesh_there) PetscFunctionReturn(0);
  input->is_copy = PETSC_TRUE;
  PetscCall(PetscStrncpy(input->mesh, input->copy, sizeof(input->mesh)));
  if (!input->quiet) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "the mesh is the run's own copy, '%s'\n", input->copy));
  PetscFunctionReturn(0);
}
