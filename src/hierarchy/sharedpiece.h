/* One piece of a shared level, by itself. */
#ifndef EQM_SHAREDPIECE_H
#define EQM_SHAREDPIECE_H

#include "hierarchy/decimation.h"
#include "hierarchy/shared.h"

/* Cells by the pieces that they touch: item[start[k]] .. of piece k. */
typedef struct {
  PetscInt *start, *item;
} EqmPieceCells;
PETSC_INTERN PetscErrorCode EqmPieceCellsCreate(const EqmSharedLevel *shared, EqmPieceCells *cells);
PETSC_INTERN PetscErrorCode EqmPieceCellsDestroy(EqmPieceCells *cells);

/* What is left of a level's cells and vertices. */
typedef struct {
  PetscInt *cells;
  PetscReal *weight;
  char *dead, *gone; /* per cell, per owned vertex */
} EqmSharedRest;

/* Room to decimate a piece, for one thread. */
typedef struct {
  EqmHierarchyLevel level; /* its vertices, then those around it; its records are places in those of the shared level */
  EqmDecimation decimation;
  PetscInt *vertex; /* local numbers in the shared level */
  char *held;
} EqmPieceWork;
/* For the largest piece. Not collective. */
PETSC_INTERN PetscErrorCode EqmPieceWorkCreate(const EqmSharedLevel *shared, const EqmPieceCells *cells,
                                               EqmPieceWork *work);
PETSC_INTERN PetscErrorCode EqmPieceWorkDestroy(EqmPieceWork *work);

/* Decimate piece k: its share of `ratio` and of the boundary vertices that stay. The records go to the shared level's
   arrays from vertex_start[k] on (ring entries: EQM_MOST_RECORD times that), in its local numbers; returns how many.
   Calls nothing of PETSc's. Not collective. */
PETSC_INTERN PetscInt EqmPieceDecimate(EqmSharedLevel *shared, PetscInt k, const EqmPieceCells *cells, PetscReal ratio,
                                       PetscInt least_boundary, EqmPieceWork *work, EqmSharedRest *rest);

#endif
