/* Maps that the iterations leave with folds, or collapsed. */
#ifndef EQM_MEND_H
#define EQM_MEND_H

#include "solver/solver_private.h"

/* Has the map of a solid drawn its boundary together so that the image is next to no ball? Collective. */
PETSC_INTERN PetscErrorCode EqmSolverHasCollapsed(EqmSolver solver, PetscBool *collapsed);
/* In place of a collapsed map: the first one once more, unfolded and brought down as far as a barrier and the volume
   of the image allow; the next iteration's number. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverBeginAgain(EqmSolver solver);
/* Mend folds of the present map, if there are any and -unfold does not forbid it; `when` is for people. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverMend(EqmSolver solver, const char *when, PetscBool *unfolded);

#endif
