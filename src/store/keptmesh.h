/* A run's own copy of a mesh that it was given: a file of the native format beside the checkpoints, written once, so
   that the run can go on where the file that it was given is gone. It holds the mesh as it was read, the density, and
   the map if one was read with it. */
#ifndef EQM_KEPTMESH_H
#define EQM_KEPTMESH_H

#include <equimap/map.h>

/* The name by which a checkpoint tells what its copies are called, separated by commas; empty: there is none. */
#define EQM_KEPT_MESH "kept_mesh"

/* What the copy for a checkpoint is called: RUN.mesh.h5 for RUN.h5; of a run that has two meshes, where `part` is "A"
   or "B", RUN.a.mesh.h5 and RUN.b.mesh.h5. Not collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshName(const char *checkpoint, const char *part, char *name, size_t length);
/* Write the copy `name`, unless one of the same mesh, density and map is there. `map` is what was read with the mesh,
   or NULL. A `resumed` run leaves a sound one of another mesh alone: its checkpoint, which is looked at later, may be
   of that mesh and refuse this one. A failure is a warning: the run itself does not need the copy. Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshWrite(EqmSoup soup, EqmMap map, const char *name, PetscBool resumed);
/* The entry of that number, from 0, of what a checkpoint, or the one before it, says of its copies; empty: nothing.
   Errors: EQM_ERR_IO (no checkpoint). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshAsk(MPI_Comm comm, const char *checkpoint, PetscInt number, char *entry,
                                           size_t length);
/* The copy that this entry speaks of; it lies in the checkpoint's folder. Errors: EQM_ERR_IO (no checkpoint),
   EQM_ERR_CHECKPOINT (it speaks of none, or the copy is gone). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshFind(MPI_Comm comm, const char *checkpoint, PetscInt number, char *name,
                                            size_t length, PetscBool *has_density);
/* Read it. Errors: EQM_ERR_IO, EQM_ERR_CHECKPOINT (damaged). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshRead(MPI_Comm comm, const char *name, EqmSoup *soup);
/* Is the map that was read from the copy, and with it that of the mended mesh, as it was written? Errors:
   EQM_ERR_CHECKPOINT. Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshCheckMap(EqmMap map, const char *name);

#endif
