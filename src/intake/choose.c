/* The mesh of a run that is continued: the named one, or the copy beside the checkpoint. */
#include "intake/intake.h"
#include "base/lookup.h"
#include "store/keptmesh.h"

/* EqmIntakeChoose - set in `options` which mesh to read: the one that is named, or, on a restart for which it is gone
   or not named, the copy beside the checkpoint; likewise the density.

   Collective. named - the command line's, or NULL; restart - the checkpoint, or NULL; options - its
   density has been filled in. Errors: those of EqmKeptMeshFind. */
PetscErrorCode EqmIntakeChoose(MPI_Comm comm, const char *named, const char *restart, EqmIntakeOptions *options)
{
  PetscBool mesh_there, density_there, has_density;

  PetscFunctionBegin;
  options->resumed = (PetscBool)(restart != NULL);
  PetscCall(PetscStrncpy(options->mesh, named ? named : "", sizeof(options->mesh)));
  PetscCall(EqmFileIsThere(comm, named, &mesh_there));
  PetscCall(EqmFileIsThere(comm, options->density, &density_there));
  if (!restart || (mesh_there && (density_there || !options->density))) PetscFunctionReturn(0);
  PetscCall(EqmKeptMeshFind(comm, restart, options->part && options->part[0] == 'B', options->copy,
                            sizeof(options->copy), &has_density));
  if (!density_there && has_density) options->density = options->copy;
  if (mesh_there) PetscFunctionReturn(0);
  options->is_copy = PETSC_TRUE;
  PetscCall(PetscStrncpy(options->mesh, options->copy, sizeof(options->mesh)));
  if (!options->quiet)
    PetscCall(PetscPrintf(comm, "%s%sthe mesh is the run's own copy, '%s'\n", options->part ? options->part : "",
                          options->part ? ": " : "", options->copy));
  PetscFunctionReturn(0);
}
