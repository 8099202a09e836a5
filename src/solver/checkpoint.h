/* Checkpoints of a run and requests to stop it, as the loop of solver.c uses them. */
#ifndef EQM_CHECKPOINT_H
#define EQM_CHECKPOINT_H

#include <equimap/solver.h>
#include "base/lockfile.h"
#include "base/stop.h"
#include "store/state.h"

/* The state of a solver's checkpoints. */
typedef struct {
  EqmState open;                      /* the one that is being loaded, between map and method; else NULL */
  EqmState writing;                   /* the one that is being written; else NULL */
  EqmLock lock;                       /* on the name of its file */
  EqmStopFile stop_file;              /* beside the checkpoint; of a run that has begun before, it has a name already */
  char kept_mesh[PETSC_MAX_PATH_LEN]; /* the run's copies of its meshes, likewise; empty: there is none */
  PetscReal cost, last;               /* seconds that the last checkpoint took, and the time at which it was written */
  PetscInt written;                   /* iteration of the last one that was written; -1: none */
  PetscInt resumed;                   /* iteration that this run began with */
  size_t suffix;                      /* length of the suffix that EqmSolverSetStage appended to the user's name */
  PetscBool finished;                 /* the method has ended: no step follows */
  PetscBool ignores_requests;         /* an inner solver of a start: the outer solver handles requests to stop */
  PetscBool failing;                  /* the last one could not be written */
} EqmCheckpoints;

/* The content of a checkpoint: all of it; the part that is loaded before the method is set up; the part that is loaded
   afterwards, which also restores the map that set_up may have changed. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointVisit(EqmState state, void *solver);
PETSC_INTERN PetscErrorCode EqmCheckpointVisitMap(EqmState state, EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmCheckpointVisitMethod(EqmState state, EqmSolver solver);

/* Set up: remove temporary files of killed runs, watch for a file STOP. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointBegin(EqmSolver solver);
/* With -restart: find the newest checkpoint that is sound, and take map and history from it, in place of a start.
   Errors: EQM_ERR_IO (there is none), EQM_ERR_CHECKPOINT (damaged, or of another run). Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointLoadMap(EqmSolver solver);
/* Then, after the method's set_up: its state, and the counters. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointLoadMethod(EqmSolver solver);
/* After an iteration: write a checkpoint if one is due. A failure is reported once, and the run goes on. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointIfDue(EqmSolver solver);
/* After the last iteration: write the last checkpoint. If that fails, the status EQM_STATUS_STOPPED of a run to be
   continued becomes EQM_STATUS_NOT_CONVERGED. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointEnd(EqmSolver solver);
/* Has a stop been requested, or is -wall_time over? Sets status and message. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointStopRequested(EqmSolver solver, PetscBool *stop);

#endif
