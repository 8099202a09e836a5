#ifndef EQM_SHAREDPROLONGATION_H
#define EQM_SHAREDPROLONGATION_H

#include "hierarchy/prolongation.h"
#include "hierarchy/sharedmap.h"

/* From a shared level to the next finer one. A rank has the rows of its fine vertices, which lead to coarse vertices
   that were among them; these come first in its coarse numbers. The vertices themselves may now be another rank's. */
typedef struct {
  EqmProlongation prolongation;
  PetscInt *number; /* per coarse column: its number on the coarser level */
  PetscSF rows; /* roots: the coarse vertices that were this rank's; leaves: those that the level gives it, or, for a
                   level that goes to the first rank, all there and none elsewhere */
} EqmSharedProlongation;

/* At a map of the finer level; `first`: the coarser one goes to the first rank. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedProlongationCreate(const EqmSharedLevel *finer, const EqmLevelMap *map,
                                                        const EqmSharedLevel *coarser, PetscBool first,
                                                        PetscInt num_ghosts, EqmSharedProlongation *to);
/* The rows of other ranks' vertices: the leaves of `halo`, num_ghosts of them, follow this rank's own. Collective. */
PETSC_INTERN PetscErrorCode EqmSharedProlongationFetch(PetscSF halo, PetscInt num_ghosts, EqmSharedProlongation *to);
PETSC_INTERN PetscErrorCode EqmSharedProlongationDestroy(EqmSharedProlongation *to);

#endif
