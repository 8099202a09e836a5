/* A mesh cut into its pieces: prepared as far as all have in common, and then every piece a mesh of its own, with no
   vertices but those it needs. To take all pieces is as much work as to take the mesh once. */
#ifndef EQM_COMPONENTS_H
#define EQM_COMPONENTS_H

#include "prepare/prepare.h"

/* Rows of this rank by the piece that they belong to: those of piece p, from 0, are start[p] .. start[p + 1] - 1 of
   `row`, ascending. */
typedef struct {
  PetscInt *start, *row;
} EqmRowsOfPieces;

typedef struct {
  EqmSoup given;
  EqmPreparation whole;       /* the steps before `largest` */
  PetscBool automatic;        /* the steps after it are those that the mesh needs */
  PetscInt num_pieces;        /* at least one */
  EqmRowsOfPieces given_cell; /* places in the slab of cells of `given`, */
  EqmRowsOfPieces cell;       /* in that of whole.soup, */
  EqmRowsOfPieces vertex;     /* and in its slab of vertices: one may serve several pieces */
  PetscInt *before;           /* per piece, how many of its vertices lower ranks have, */
  PetscInt *num_kept;         /* and how many of those here are `given`'s: the first ones */
  PetscInt *given_corner;     /* 3 or 4 per row of given_cell: vertices in the numbering of the piece */
  PetscInt *corner;           /* the same per row of `cell`, */
  PetscInt *parent;           /* and its parent among the piece's given cells, or -1 */
  PetscInt *stand_in;         /* per row of `vertex`: the vertex of the piece that stands for it, */
  PetscReal *given_position;  /* and where `given` has it, 3 each */
} EqmComponents;

/* EqmComponentsCreate - prepare a mesh, which stays and must remain, up to the step `largest`, and find its pieces, the
   largest first. Collective; EqmComponentsReset must follow. */
PETSC_INTERN PetscErrorCode EqmComponentsCreate(EqmSoup given, const EqmPrepareOptions *options,
                                                EqmComponents *components);
PETSC_INTERN PetscErrorCode EqmComponentsReset(EqmComponents *components);
/* EqmComponentsTake - the piece of that number, from 0: its cells of the file, and what the steps so far have made of
   them, in the order of the whole and in numberings of their own. Collective. given - to be freed with EqmSoupDestroy;
   begun - a preparation of it, for EqmPrepareRest and EqmPreparationReset. */
PETSC_INTERN PetscErrorCode EqmComponentsTake(const EqmComponents *components, PetscInt piece, EqmSoup *given,
                                              EqmPreparation *begun);
/* EqmComponentsName - the numbers in the prepared whole for `count` vertices of that piece; those that later steps have
   added follow. Collective, with the same numbers on every rank. */
PETSC_INTERN PetscErrorCode EqmComponentsName(const EqmComponents *components, PetscInt piece, PetscInt count,
                                              PetscInt *number);
/* EqmPrepareRest - the steps after `largest`, on what those before have made of `given`. Collective. */
PETSC_INTERN PetscErrorCode EqmPrepareRest(EqmSoup given, const EqmPrepareOptions *options, PetscBool automatic,
                                           EqmPreparation *preparation);
/* EqmPrepareShared - the steps before it: what does not depend on which piece is kept. Collective. */
PETSC_INTERN PetscErrorCode EqmPrepareShared(EqmSoup given, const EqmPrepareOptions *options, PetscBool *automatic,
                                             EqmPreparation *preparation);

#endif
