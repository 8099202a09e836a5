/* Checkpoints of a run and requests to stop it, as the loop of solver.c uses them. */
#ifndef EQM_CHECKPOINT_H
#define EQM_CHECKPOINT_H

#include <equimap/solver.h>
#include "base/stop.h"
#include "store/state.h"

/* What a solver knows of its checkpoints. */
typedef struct {
  EqmState open;                      /* the one that is being loaded, between map and method; else NULL */
  EqmState writing;                   /* the last one, while the disk may still be at work; else NULL */
  EqmStopFile stop_file;              /* beside the checkpoint; of a run that has begun before, it has a name already */
  char kept_mesh[PETSC_MAX_PATH_LEN]; /* the run's copies of its meshes, likewise; empty: there is none */
  PetscReal cost, last;               /* seconds that the last checkpoint took, and when it was written */
  PetscInt written;                   /* iteration of the last one that was written; -1: none */
  PetscInt resumed;                   /* iteration that this run began with */
  size_t suffix;                      /* length of what EqmSolverSetStage has put behind the user's name */
  PetscBool finished;                 /* the method itself has ended: no step follows */
  PetscBool ignores_requests;         /* a map within another run's start: requests to stop are for that run */
  PetscBool failing;                  /* the last one could not be written */
} EqmCheckpoints;

/* What a checkpoint holds: all of it; what can be known before the method is set up; the rest, which also sets right
   what set_up has done to the map. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointVisit(EqmState state, void *solver);
PETSC_INTERN PetscErrorCode EqmCheckpointVisitMap(EqmState state, EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmCheckpointVisitMethod(EqmState state, EqmSolver solver);

/* Get ready: leftovers of killed runs are removed, a file STOP is watched for. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointBegin(EqmSolver solver);
/* With -restart: find the newest checkpoint that is sound, and take map and history from it, in place of a start.
   Errors: EQM_ERR_IO (there is none), EQM_ERR_CHECKPOINT (damaged, or of another run). Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointLoadMap(EqmSolver solver);
/* Then, after the method's set_up: its state, and the counters. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointLoadMethod(EqmSolver solver);
/* After an iteration: write one if it is time. A failure is told once, and the run goes on. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointIfDue(EqmSolver solver);
/* After the last iteration: write what has not been written. If the run was to be continued later and that fails, it is
   a run that just did not converge. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointEnd(EqmSolver solver);
/* Has somebody asked to stop, or is -wall_time over? Says so in status and message. Collective. */
PETSC_INTERN PetscErrorCode EqmCheckpointAskedToStop(EqmSolver solver, PetscBool *stop);

#endif
