/* A run's own copy of its input mesh: a file of the native format beside the checkpoints, written once, so that the run
   can be restarted when the input file is gone. It holds the mesh as it was read, the density, and
   the map if one was read with it. */
#ifndef EQM_KEPTMESH_H
#define EQM_KEPTMESH_H

#include <equimap/map.h>

/* The attribute of a checkpoint that holds the names of its copies, separated by commas; empty: there is none. */
#define EQM_KEPT_MESH "kept_mesh"

/* The name of the copy for a checkpoint: RUN.mesh.h5 for RUN.h5; of a run that has two meshes, where `part` is "A"
   or "B", RUN.a.mesh.h5 and RUN.b.mesh.h5. Not collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshName(const char *checkpoint, const char *part, char *name, size_t length);
/* Write the copy `name`, unless one of the same mesh, density and map is there. `map` is what was read with the mesh,
   or NULL. A `resumed` run does not replace an undamaged copy of another mesh: its checkpoint, which is read later,
   may be of that mesh and refuse this one. A failure is a warning: the run itself does not need the copy. Collective.
 */
PETSC_INTERN PetscErrorCode EqmKeptMeshWrite(EqmSoup soup, EqmMap map, const char *name, PetscBool resumed);
/* The name of copy `number`, from 0, that a checkpoint, or the one before it, holds; empty: none.
   Errors: EQM_ERR_IO (no checkpoint). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshGetEntry(MPI_Comm comm, const char *checkpoint, PetscInt number, char *entry,
                                                size_t length);
/* The path of that copy, which lies in the checkpoint's folder. Errors: EQM_ERR_IO (no checkpoint),
   EQM_ERR_CHECKPOINT (there is no such entry, or the copy is gone). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshFind(MPI_Comm comm, const char *checkpoint, PetscInt number, char *name,
                                            size_t length, PetscBool *has_density);
/* Read it. Errors: EQM_ERR_IO, EQM_ERR_CHECKPOINT (damaged). Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshRead(MPI_Comm comm, const char *name, EqmSoup *soup);
/* Compare the map that was read from the copy, and that of the repaired mesh, with their checksum. Errors:
   EQM_ERR_CHECKPOINT. Collective. */
PETSC_INTERN PetscErrorCode EqmKeptMeshCheckMap(EqmMap map, const char *name);

#endif
