/* A solver's cells on the finest level of a hierarchy: those of the mesh in another order, on other ranks. */
#ifndef EQM_LEVELCELLS_H
#define EQM_LEVELCELLS_H

#include "hierarchy/levelsystem.h"
#include "linalg/linalg.h"

typedef struct {
  const PetscInt *order; /* place of each cell of the level among the owned cells of all ranks */
  PetscSF sf;            /* roots: owned cells; leaves: the level's; NULL on one rank alone */
  PetscReal *packed;     /* matrices of the level's cells, between EqmLevelCellsSend and EqmLevelCellsAssemble */
} EqmLevelCells;

/* `order`, of the `num` cells that the level has on this rank, must outlive it. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelCellsCreate(EqmMesh mesh, PetscInt num, const PetscInt *order,
                                                EqmLevelCells *cells);
PETSC_INTERN PetscErrorCode EqmLevelCellsDestroy(EqmLevelCells *cells);
/* The matrices of `linear`'s cells to where the level has them. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelCellsSend(EqmLinear linear, EqmLevelCells *cells);
/* Add them all up in a system of the level, whose diagonal gets the solver's factor. `success` as of EqmLevelSystemEnd.
   Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelCellsAssemble(EqmLinear linear, EqmLevelCells *cells, EqmLevelSystem *system,
                                                  PetscBool *success);

#endif
