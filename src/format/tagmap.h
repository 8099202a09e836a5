/* From the tags that a file gives its vertices, in any order and with gaps, to numbers from 0 in file order. */
#ifndef EQM_FORMAT_TAGMAP_H
#define EQM_FORMAT_TAGMAP_H

#include <equimap/base.h>

typedef struct {
  size_t count, capacity;
  PetscInt64 *tag;       /* in file order; ascending after EqmTagMapClose */
  PetscInt64 first;      /* tags are first, first + 1, ... in file order while `consecutive` */
  PetscBool consecutive; /* the common case, which needs no search */
  PetscInt *number;      /* otherwise: number of the vertex that has tag[i] */
} EqmTagMap;

PETSC_INTERN PetscErrorCode EqmTagMapReserve(EqmTagMap *map, size_t count);
PETSC_INTERN void EqmTagMapAdd(EqmTagMap *map, PetscInt64 tag);
PETSC_INTERN PetscErrorCode EqmTagMapClose(EqmTagMap *map, PetscInt64 *repeated);
PETSC_INTERN PetscInt EqmTagMapFind(const EqmTagMap *map, PetscInt64 tag);
/* EqmTagMapShare - from the tags of this rank's vertices, which have not been closed, to a map of those of all ranks.
   Collective. consecutive - false: the map remains as it is, and EqmTagMapShareNamed must follow, which makes one of
   the vertices that have one of the `num_named` tags `named` (sorted here). success - false on every rank if there are
   more vertices than PetscInt can count, or two have the same tag. */
PETSC_INTERN PetscErrorCode EqmTagMapShare(MPI_Comm comm, EqmTagMap *map, PetscBool *consecutive, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmTagMapShareNamed(MPI_Comm comm, EqmTagMap *map, PetscInt64 num_named, PetscInt64 *named,
                                                PetscBool *success);
PETSC_INTERN PetscErrorCode EqmTagMapReset(EqmTagMap *map);

#endif
