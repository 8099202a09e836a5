/* Functions for solvers inside other solvers, beyond the public interface: the stages of a registration, the ball's
   start. */
#ifndef EQM_SOLVER_INNER_H
#define EQM_SOLVER_INNER_H

#include <equimap/solver.h>
#include "base/stop.h"

/* The run is the `stage`-th minimisation of several, counted from 1, each with a checkpoint of its own: the names of
   -checkpoint and -restart get .STAGE behind. A later stage whose checkpoint is not there begins anew. Call after
   EqmSolverSetFromOptions. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverSetStage(EqmSolver solver, PetscInt stage);
/* Use the watch for the file STOP that began with the whole run. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverSetStopFile(EqmSolver solver, const EqmStopFile *watch);
/* Ignore requests to stop: a start that is cut short would be another start. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverIgnoreStopRequests(EqmSolver solver);
/* The name that checkpoints give for the run's copies of its meshes. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverSetKeptMesh(EqmSolver solver, const char *name);
/* Did the last attempt to write a checkpoint fail? Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverCheckpointFailed(EqmSolver solver, PetscBool *failed);
/* Disk: hold the boundary where the map of EqmSolverSetFirstMap has it. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverHoldBoundary(EqmSolver solver);
/* The method that is set, "auto" resolved. After EqmSolverSetFromOptions. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverGetMethodName(EqmSolver solver, const char **name);
/* lm: at most so many quasi-Newton steps on each factor, unless -lm_inner says otherwise. Not collective. */
PETSC_INTERN PetscErrorCode EqmSolverSetInnerSteps(EqmSolver solver, PetscInt steps);
/* Does the method that is set take landmarks? Errors: EQM_ERR_USAGE if it does not. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverRequireLandmarks(EqmSolver solver);

#endif
