/* What repair and refinement have in common: new vertices on edges, and a soup put together from parts. */
#ifndef EQM_SUBDIVIDE_H
#define EQM_SUBDIVIDE_H

#include <equimap/simplex.h>
#include "mesh/diagnose.h"

/* Vertices of one origin, held by the ranks in order of their numbers. */
typedef struct {
  PetscInt num_local, start; /* `start`: this rank's first, counted within the group */
  PetscInt num_global;
  PetscReal *position; /* 3 * num_local */
} EqmVertexGroup;

/* New cells on any rank: per cell a record of its parent's input number and its vertices, the children of one parent on
   one rank and in their order. */
typedef struct {
  PetscInt cell_size, count, capacity;
  PetscInt *records;
} EqmCellList;

PETSC_INTERN PetscErrorCode EqmEdgesNumber(const EqmVicinity *vicinity, const PetscBool *on_boundary,
                                           EqmVertexGroup *midpoints, PetscInt *edge_vertex);
PETSC_INTERN PetscErrorCode EqmVertexGroupPlace(MPI_Comm comm, EqmVertexGroup *group);
PETSC_INTERN PetscErrorCode EqmCellListAdd(EqmCellList *list, PetscInt parent, const PetscInt *vertices);
PETSC_INTERN PetscErrorCode EqmSoupAssemble(EqmSoup *soup, PetscInt num_groups, const EqmVertexGroup *groups,
                                            EqmCellList *list, PetscInt **parent);

#endif
