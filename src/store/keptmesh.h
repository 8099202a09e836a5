/* A run's own copy of its mesh: a file of the native format beside the checkpoints, written once, so that the run can
   go on where the file that it was given is gone. It holds the mesh as it was read, and the density. */
#ifndef EQM_KEPTMESH_H
#define EQM_KEPTMESH_H

#include <equimap/soup.h>

/* The name by which a checkpoint tells what its copy is called; empty: there is none. */
#define EQM_KEPT_MESH "kept_mesh"

/* What the copy for a checkpoint is called: RUN.mesh.h5 for RUN.h5. Not collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshName(const char *checkpoint, char *name, size_t length);
/* Write the copy, unless one of the same mesh and density is there. A `resumed` run leaves a sound one of another mesh
   alone: its checkpoint, which is looked at later, may be of that mesh and refuse this one. A failure is a warning: the
   run itself does not need the copy. Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshWrite(EqmSoup soup, const char *checkpoint, PetscBool resumed);
/* The copy that a checkpoint, or the one before it, speaks of; it lies in the checkpoint's folder. Errors: EQM_ERR_IO
   (no checkpoint), EQM_ERR_CHECKPOINT (it speaks of none, or the copy is gone). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshFind(MPI_Comm comm, const char *checkpoint, char *name, size_t length,
                                            PetscBool *has_density);
/* Read it. Errors: EQM_ERR_IO, EQM_ERR_CHECKPOINT (damaged). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshRead(MPI_Comm comm, const char *name, EqmSoup *soup);

#endif
