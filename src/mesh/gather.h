/* Values at a few vertices, on every rank. */
#ifndef EQM_MESH_GATHER_H
#define EQM_MESH_GATHER_H

#include <equimap/mesh.h>

/* `width` reals of each of `num` vertices, which are given by their input numbers, from `values` per owned vertex; the
   same on every rank. `missing`, which may be NULL, is the index of the first vertex that no cell uses, -1 if there is
   none; the values of such vertices are zero. Collective. */
PETSC_INTERN PetscErrorCode EqmMeshGatherVertices(EqmMesh mesh, PetscInt num, const PetscInt *vertices, PetscInt width,
                                                  const PetscReal *values, PetscReal *gathered, PetscInt *missing);

#endif
