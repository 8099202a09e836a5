/* A problem's mesh as a hierarchy of coarser ones (src/hierarchy), and cascades on it. */
#ifndef EQM_LEVELS_H
#define EQM_LEVELS_H

#include "hierarchy/relaxer.h"
#include "problem/problem.h"

/* One of the two: all levels on the first rank, for small meshes; or the finest levels on all ranks. */
typedef struct EqmLevels {
  EqmProblem problem;
  EqmCascadeTarget target;
  EqmHierarchy hierarchy;
  EqmShared shared;
} EqmLevels;

/* Why there can be none for this problem, as the end of a sentence about "it"; NULL: there can. Not collective. */
PETSC_INTERN const char *EqmLevelsObstacle(EqmProblem problem);
/* The same for a linear solver on them. */
PETSC_INTERN const char *EqmLevelsObstacleToLinear(EqmProblem problem);
/* The problem's levels, made at the first need; corners of the square stay on all of them. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemGetLevels(EqmProblem problem, EqmLevels **levels);
/* A solver of kind hierarchy, on the problem's levels, for the domain's degrees of freedom. Collective. */
PETSC_INTERN PetscErrorCode EqmProblemCreateLinearOnLevels(EqmProblem problem, EqmLinear *linear);
/* EqmCascade on them: boundary vertices of the place, which is set, ghosts included, are set on entry; frames are not
   chosen anew. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelsCascade(EqmLevels *levels, const EqmCascadeOptions *options, EqmPlace *place,
                                             EqmCascadeResult *result);
/* Relax maps of the problem again and again (hierarchy/relaxer.h). Collective. */
PETSC_INTERN PetscErrorCode EqmLevelsCreateRelaxer(EqmLevels *levels, EqmRelaxer *relaxer);
/* EqmRelaxerRun from one place to another. Collective. */
PETSC_INTERN PetscErrorCode EqmLevelsRelax(EqmLevels *levels, EqmRelaxer relaxer, const EqmCascadeOptions *options,
                                           const EqmPlace *from, EqmPlace *to, EqmCascadeResult *result);

#endif
