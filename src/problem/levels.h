/* A problem's mesh as a hierarchy of coarser ones (src/hierarchy), and maps on their way to it and back. */
#ifndef EQM_LEVELS_H
#define EQM_LEVELS_H

#include "hierarchy/cascade.h"
#include "problem/problem.h"

typedef struct {
  EqmProblem problem;
  EqmHierarchy hierarchy;
  EqmCascadeTarget target;
  PetscReal *x; /* on the first rank: the places of the finest level's vertices */
} EqmLevels;

/* Why there can be none for this problem, as the end of a sentence about "it"; NULL: there can. Not collective. */
PETSC_INTERN const char *EqmLevelsObstacle(EqmProblem problem);
/* Corners of the square stay on all levels. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelsCreate(EqmProblem problem, EqmLevels *levels);
PETSC_INTERN PetscErrorCode EqmLevelsDestroy(EqmLevels *levels);
/* From the place to x, and back, ghosts included; frames are not chosen anew. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelsGather(EqmLevels *levels, const EqmPlace *place);
PETSC_INTERN PetscErrorCode EqmLevelsScatter(EqmLevels *levels, EqmPlace *place);

#endif
