/* Bijectivity repair: each function tries to unfold a map and leaves the one with the fewest folds, its image and
   totals up to date; `before` and `after` count folds. Collective. */
#ifndef EQM_UNFOLD_H
#define EQM_UNFOLD_H

#include "problem/problem.h"
#include "problem/term.h"

PETSC_INTERN PetscErrorCode EqmDiskUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before,
                                          PetscInt64 *after);
PETSC_INTERN PetscErrorCode EqmSphereUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before,
                                            PetscInt64 *after);
/* Disk and square, boundary held: what is far from the folds stays as it is. */
PETSC_INTERN PetscErrorCode EqmPlaneUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before,
                                           PetscInt64 *after);
PETSC_INTERN PetscErrorCode EqmSphereUnfoldAsPrinted(EqmProblem problem, EqmIterate iterate, PetscInt64 *before,
                                                     PetscInt64 *after);
/* Unfold a first map as problem->unfolding has it, and note the folds in the iterate. */
PETSC_INTERN PetscErrorCode EqmSphereUnfoldFirstMap(EqmProblem problem, EqmIterate iterate);
/* Requests to stop are checked between rounds (EqmProblemStopRequested). */
PETSC_INTERN PetscErrorCode EqmBallUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before,
                                          PetscInt64 *after);

/* A term weight (T - A)^2 / T for a structure of the caller's: the volume A of the image shall be the ball's, T. Not
   collective. */
PETSC_INTERN void EqmTermInitVolume(EqmTerm term, PetscReal weight);

#endif
