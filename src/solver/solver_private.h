/* The fields of a solver, private to this folder. */
#ifndef EQM_SOLVER_PRIVATE_H
#define EQM_SOLVER_PRIVATE_H

#include <equimap/solver.h>
#include "solver/checkpoint.h"
#include "solver/formulation.h"
#include "solver/normalise.h"

/* The common settings; a negative number leaves the decision to the method. */
typedef struct {
  char method[32];
  char objective[32]; /* empty: the formulation's */
  EqmStartOptions start;
  PetscInt max_it, max_factorizations;
  PetscReal energy_rtol, energy_atol, ratio_tol, energy_target, gradient_tol, wall_time;
  PetscReal balance, balance_energy;
  PetscInt stagnation;  /* iterations that energy_rtol refers to */
  PetscInt inner_steps; /* of lm, before its options are read */
  PetscInt unfolding;   /* an EqmUnfolding */
  PetscBool quiet, has_corners;
  PetscBool hold_boundary; /* disk: where the first map has it */
  PetscInt corners[4];
  char boundary_angles[PETSC_MAX_PATH_LEN];                         /* disk: a file; empty: none */
  char checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN]; /* empty: none */
  PetscInt checkpoint_every;                                        /* iterations; 0: only at the end */
  EqmNormaliseSettings normalise;                                   /* conformal, closed surfaces */
} EqmSolverSettings;

struct _p_EqmSolver {
  MPI_Comm comm;
  EqmMesh mesh; /* NULL where options are only listed */
  char target[16], prefix[32];
  EqmSolverSettings settings;
  const EqmFormulation *formulation;
  const EqmObjective *objective;
  EqmMethodDefaults defaults; /* of the method for the formulation */
  const EqmStartType *start;
  EqmMethod method; /* NULL before EqmSolverResolveSettings */
  PetscBool is_set_up;

  EqmProblem problem;
  EqmIterate iterate;
  PetscReal *first_map; /* given from outside, first_map_dim per owned vertex; NULL: -start makes it */
  PetscInt first_map_dim;
  EqmLandmarks landmarks; /* as given; the problem's from SetUp on */

  PetscReal *objectives; /* of every iteration, num_history long */
  EqmHistoryRow *history;
  PetscInt num_history, max_history;
  EqmStatus status;
  char message[EQM_MESSAGE_MAX];
  PetscInt begun_again; /* the row of the history at which the iterations began once more, after a collapse or with
                           another residual; 0: never */
  PetscBool poor;       /* not converged, and far from equal areas */
  PetscBool collapsed;  /* the iterations ended at no map of the solid to the ball (mend.c) */
  PetscBool limited;    /* the iterations ended by a limit of the user's, not by themselves */
  EqmCheckpoints checkpoints;

  EqmMonitor monitor;
  void *monitor_context;
  PetscReal last_shown; /* the text monitor's: seconds when the last row was printed */
  PetscInt rows_shown;  /* and num_history at that time */
};

/* ---- options.c, resolve.c */
PETSC_INTERN PetscErrorCode EqmSolverSettingsDefault(EqmSolverSettings *settings);
/* Look up method and start, and set unset values to the formulation's defaults. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverResolveSettings(EqmSolver solver);
/* Values that no method takes. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverCheckSettings(EqmSolver solver);
/* The objective and the method that the settings name; its options are read unless PetscOptionsObject is NULL.
 * Collective. */
PETSC_INTERN PetscErrorCode EqmSolverFindMethod(EqmSolver solver, PetscOptionItems *PetscOptionsObject);
/* Create a method with the formulation's settings, then read its options unless PetscOptionsObject is NULL. Collective.
 */
PETSC_INTERN PetscErrorCode EqmSolverCreateMethod(EqmSolver solver, const EqmMethodDefaults *defaults,
                                                  PetscOptionItems *PetscOptionsObject, EqmMethod *method);
/* Read every option that the target could have. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverListOptions(EqmSolver solver);
/* ---- first_map.c: the first map: one that was given, or a start's. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverMakeFirstMap(EqmSolver solver);
/* Say how surfaces of solids are mapped to the sphere; and of a map to the cube where its boundary lies, three
   coordinates per local vertex, to be freed: as in the map to begin with, or by the surface's map. NULL elsewhere.
   Collective. */
PETSC_INTERN PetscErrorCode EqmSolverBoundaryPlaces(EqmSolver solver, EqmMapSurface map_surface, PetscReal **places);
/* ---- held.c: the angles that hold the boundary, per local vertex; NULL: nothing holds it. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverHeldAngles(EqmSolver solver, PetscReal **angles);
/* ---- history.c */
PETSC_INTERN PetscErrorCode EqmHistoryReserve(EqmSolver solver, PetscInt rows);
/* Add a row for the present map and call the monitor. Collective. */
PETSC_INTERN PetscErrorCode EqmHistoryAddRow(EqmSolver solver);
PETSC_INTERN PetscErrorCode EqmSolverCallMonitor(EqmSolver solver, EqmMonitorEvent event, const char *text);
/* Pass a line of text to the monitor; a problem's `notify`, whose context is the solver. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverNotify(void *solver, const char *text);
PETSC_INTERN PetscErrorCode EqmSolverNotifyUnfolded(EqmSolver solver, const char *when);
/* Prefix of the options of the surface's map in the ball's start. */
#define EQM_BOUNDARY_PREFIX "boundary_"
/* ---- attempts.c: where the run has not come close to the objective, another residual from its map, then other starts;
   the best map is the solver's. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverTryAgain(EqmSolver solver);
/* Has the default's start left folds that the method cannot take? Not collective. */
PETSC_INTERN PetscBool EqmSolverIsBlocked(EqmSolver solver);
/* ---- run.c: from the first map to the end of iterations and unfolding. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverRun(EqmSolver solver);
/* ---- hessian_stretch.c: the Hessian of a^2/area of one triangle (001 Appendix B). Not collective. */
PETSC_INTERN void EqmStretchHessian(const PetscReal *const p[3], PetscReal area, PetscReal matrix[81]);
/* ---- intrinsic.c: the second attempt of EqmSolverSolve. Collective. */
PETSC_INTERN PetscErrorCode EqmSolverStraighten(EqmSolver solver);

/* Refuse landmarks for a method without them, after EqmSolverResolveSettings. Errors: EQM_ERR_USAGE.
   Collective. */
PETSC_INTERN PetscErrorCode EqmSolverCheckLandmarkSupport(EqmSolver solver);

#endif
