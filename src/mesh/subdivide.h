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

/* New cells on any rank: per cell a record of its parent's input number (-1: it has none) and its vertices, the
   children of one parent on one rank and in their order. */
typedef struct {
  PetscInt cell_size, count, capacity;
  PetscInt *records;
} EqmCellList;

PETSC_INTERN PetscErrorCode EqmEdgesNumber(const EqmVicinity *vicinity, const PetscBool *on_boundary,
                                           EqmVertexGroup *midpoints, PetscInt *edge_vertex);
PETSC_INTERN PetscErrorCode EqmVertexGroupPlace(MPI_Comm comm, EqmVertexGroup *group);
PETSC_INTERN PetscErrorCode EqmCellListAdd(EqmCellList *list, PetscInt parent, const PetscInt *vertices);
/* Cells that the vicinity leaves out: those that repeat a vertex are counted, those that name a missing one are kept,
   with -1 for that vertex, which no added vertex will make valid. Not collective. */
PETSC_INTERN PetscErrorCode EqmCellListAddUnusable(EqmSoup soup, EqmCellList *list, PetscInt64 *repeated);
/* Leave out later duplicates of cells; `removed` counts this rank's own. Not collective. */
PETSC_INTERN PetscErrorCode EqmVicinityRemoveDuplicates(EqmVicinity *vicinity, PetscInt64 *removed);
/* Per cell, whether to turn it over: of each piece the minority of the triangles, all tetrahedra of negative volume.
   Collective. */
PETSC_INTERN PetscErrorCode EqmVicinityChooseTurns(EqmSoup soup, const EqmVicinity *vicinity, PetscBool *turn);
/* EqmSoupRepair; with `split` false no cell is split. Collective. */
PETSC_INTERN PetscErrorCode EqmSoupRepairWith(EqmSoup *soup, PetscBool split, EqmRepair *repair, PetscInt **parent);
PETSC_INTERN PetscErrorCode EqmSoupAssemble(EqmSoup *soup, PetscInt num_groups, const EqmVertexGroup *groups,
                                            EqmCellList *list, PetscInt **parent);

#endif
