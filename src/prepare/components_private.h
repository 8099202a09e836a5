/* Numberings of the vertices of pieces; private to this folder. */
#ifndef EQM_COMPONENTS_PRIVATE_H
#define EQM_COMPONENTS_PRIVATE_H

#include "prepare/components.h"

/* A vertex in a piece: the same vertex may be in several, and has a number in each. */
typedef struct {
  PetscInt piece, vertex;
  PetscInt number; /* in the piece */
} EqmPlaceInPiece;

/* Those that this rank's cells ask for: ascending by piece and vertex. */
typedef struct {
  PetscInt count, capacity;
  EqmPlaceInPiece *place;
} EqmPlacesInPieces;

/* EqmPlacesAdd - ask for a vertex of a piece. Not collective. EqmPlacesNumber - number those of all ranks: vertices of
   a piece ascending. Fills `vertex`, `before` and `num_kept`. Collective. EqmPlacesFind - the number of one that was
   asked for, -1 otherwise. Not collective. EqmPlacesStandIns - fills `stand_in`, in which a vertex stands for itself
   but where this list has the number of another one. Collective. */
PETSC_INTERN PetscErrorCode EqmPlacesAdd(EqmPlacesInPieces *places, PetscInt piece, PetscInt vertex);
PETSC_INTERN PetscErrorCode EqmPlacesNumber(EqmPlacesInPieces *places, EqmComponents *components);
PETSC_INTERN PetscInt EqmPlacesFind(const EqmPlacesInPieces *places, PetscInt piece, PetscInt vertex);
PETSC_INTERN PetscErrorCode EqmPlacesStandIns(const EqmPlacesInPieces *stand_ins, EqmComponents *components);

#endif
