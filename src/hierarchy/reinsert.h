#ifndef EQM_REINSERT_H
#define EQM_REINSERT_H

#include "hierarchy/relax.h"

/* Carry the map of a coarser level to the next finer one, `to`, whose motions are set: the vertices that went come back
   one by one, the last first, each to where no triangle of its star is folded. `hard` counts those for which the mean
   value coordinates of the surface were no such place. Not collective. */
PETSC_INTERN PetscErrorCode EqmReinsert(const EqmLevelMap *from, EqmLevelMap *to, PetscInt *hard);
/* The vertices of the records begin .. end - 1, the last first, when all others of their rings have their places.
   Returns the count of hard ones. Not collective. */
PETSC_INTERN PetscInt EqmReinsertRecords(PetscInt begin, PetscInt end, EqmLevelMap *map);

#endif
