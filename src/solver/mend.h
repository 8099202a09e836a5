/* Maps that the iterations leave with folds, or collapsed. */
#ifndef EQM_MEND_H
#define EQM_MEND_H

#include "solver/solver_private.h"

/* Has the map of a solid drawn its boundary together so that the image is next to no ball? Collective. */
PETSC_INTERN PetscErrorCode EqmSolverHasCollapsed(EqmSolver solver, PetscBool *collapsed);
/* In place of a collapsed map: the first one once more, unfolded and brought down as far as a barrier and the volume
   of the image allow; the next iteration's number. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverBeginAgain(EqmSolver solver);
/* Mend the folds that there are, of cells and of a solid's boundary, if the formulation knows how. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverMend(EqmSolver solver);

#endif
