/* The boundary loops of a surface, gathered on one rank; private to this folder. */
#ifndef EQM_LOOPS_H
#define EQM_LOOPS_H

#include "mesh/soup_private.h"
#include "prepare/step.h"

/* The boundary on rank 0. */
typedef struct {
  PetscInt num_edges, num_chords, num_loops;
  EqmBoundaryEdge *edge; /* ascending by tail */
  PetscInt (*chord)[2];  /* interior edges between boundary vertices, places of their ends in `edge`, ascending */
  PetscInt *order;       /* the edges along the loops */
  PetscInt *loop_start;  /* num_loops + 1, in `order` */
  PetscInt *same;        /* per edge the one whose tail its tail is, once loops are cut where they touch themselves */
} EqmBoundary;

/* Gather the boundary edges, with the surface on their left, and the chords. Collective. */
PETSC_INTERN PetscErrorCode EqmBoundaryGather(const EqmVicinity *vicinity, EqmBoundary *boundary);
PETSC_INTERN PetscErrorCode EqmBoundaryReset(EqmBoundary *boundary);

/* Not collective: on rank 0; on others there are no loops. */
PETSC_INTERN PetscErrorCode EqmBoundaryChain(EqmBoundary *boundary);
/* The loop that stays open; -1: there is none. */
PETSC_INTERN PetscInt EqmBoundaryLongestLoop(const EqmBoundary *boundary);
PETSC_INTERN PetscErrorCode EqmBoundaryCutLoops(PetscInt open, EqmBoundary *boundary);
/* The chords of one loop of n edges as pairs of places in it. `place` is scratch, -1 per edge. */
PETSC_INTERN PetscErrorCode EqmBoundaryChords(const EqmBoundary *boundary, PetscInt n, const PetscInt *loop,
                                              PetscInt *place, PetscInt *num_chords, PetscInt (*chord)[2]);

#endif
