/* From a mesh and a target to a map: first map, iterations, unfolding.

   In PETSc's manner: create, set, set from options, solve, get, destroy. Nothing needs to be set; nothing is printed
   unless a monitor is set. Functions that set something are not collective unless it is said otherwise, but must be
   called with the same values on every rank; they come before EqmSolverSetUp or EqmSolverSolve, functions that get
   something of a map come after it: else the error PETSC_ERR_ORDER says which comes first. */
#ifndef EQUIMAP_SOLVER_H
#define EQUIMAP_SOLVER_H

#include <petscviewer.h>
#include <equimap/energy.h>
#include <equimap/map.h>

/* Finds a map of a mesh. */
typedef struct _p_EqmSolver *EqmSolver;

/* EqmSolverCreate - a solver for maps of `mesh` to `target`: "disk", "square", "sphere", "ball" or "conformal".

   Collective. The mesh, and the soup that it was made of, must outlive the solver. Errors: EQM_ERR_USAGE (no such
   target, or the mesh is not of its kind). */
PETSC_EXTERN PetscErrorCode EqmSolverCreate(EqmMesh mesh, const char *target, EqmSolver *solver);
/* EqmSolverDestroy - free a solver and set it to NULL; nothing happens if it is NULL. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverDestroy(EqmSolver *solver);

/* ---- settings */

/* EqmSolverSetOptionsPrefix - options are read as -PREFIXmax_it and so on; "" (as created): without one. At most 31
   characters. */
PETSC_EXTERN PetscErrorCode EqmSolverSetOptionsPrefix(EqmSolver solver, const char *prefix);
/* EqmSolverSetMethod - the iteration by its name, as -method has it; "auto" (as created): the target's own. The name is
   looked up when the solver is set up. */
PETSC_EXTERN PetscErrorCode EqmSolverSetMethod(EqmSolver solver, const char *name);
/* EqmSolverSetStart - the first map by its name, as -start has it; "" (as created): the method's own. */
PETSC_EXTERN PetscErrorCode EqmSolverSetStart(EqmSolver solver, const char *name);
/* EqmSolverSetTolerances - when to stop, as -energy_rtol, -ratio_tol, -gradient_tol and -max_it have it; PETSC_DEFAULT
   keeps what is set, as created the method's own. Zero tolerances are never met. */
PETSC_EXTERN PetscErrorCode EqmSolverSetTolerances(EqmSolver solver, PetscReal energy_rtol, PetscReal ratio_tol,
                                                   PetscReal gradient_tol, PetscInt max_it);
/* EqmSolverSetBalance - weight of the angle energy beside the area energy, as -balance has it (docs/methods.md). */
PETSC_EXTERN PetscErrorCode EqmSolverSetBalance(EqmSolver solver, PetscReal epsilon);
/* EqmSolverSetBalanceEnergy - lower the weight of the angle energy until the area energy is no more than this, as
   -balance_energy has it. */
PETSC_EXTERN PetscErrorCode EqmSolverSetBalanceEnergy(EqmSolver solver, PetscReal energy);
/* EqmSolverSetCorners - square: four boundary vertices (input numbers) for (0,0), (1,0), (1,1), (0,1). */
PETSC_EXTERN PetscErrorCode EqmSolverSetCorners(EqmSolver solver, const PetscInt corners[4]);
/* EqmSolverSetFirstMap - begin with the map that has the given places (of the target, `dim` coordinates per owned
   vertex) in place of -start. `x` is copied. */
PETSC_EXTERN PetscErrorCode EqmSolverSetFirstMap(EqmSolver solver, PetscInt dim, const PetscReal *x);
/* EqmSolverSetLandmarks - draw vertices (input numbers, `num` of them, the same lists on every rank) towards places of
   the target, `dim` coordinates each: the objective gets the term lambda sum w_i |x(v_i) - q_i|^2 (000 (46), 001
   section 6.6), `weights` w_i above zero, NULL: all 1, and the map is not done before each is closer than `tolerance`.
   The lists are copied. Errors, when the solver is set up: EQM_ERR_USAGE (the method takes no landmarks). */
PETSC_EXTERN PetscErrorCode EqmSolverSetLandmarks(EqmSolver solver, PetscInt num, PetscInt dim,
                                                  const PetscInt *vertices, const PetscReal *places,
                                                  const PetscReal *weights, PetscReal lambda, PetscReal tolerance);
/* EqmSolverSetFromOptions - read the options that `equimap TARGET --help` lists under Map; with -help in the options
   database, print them. Collective. Errors: EQM_ERR_USAGE. */
PETSC_EXTERN PetscErrorCode EqmSolverSetFromOptions(EqmSolver solver);

/* What a monitor is called for. */
typedef enum {
  EQM_MONITOR_BEGIN,     /* the method is ready for its first step; `text` describes the linear solver, or is empty */
  EQM_MONITOR_ITERATION, /* the history has a new row */
  EQM_MONITOR_NOTE,      /* `text` is a line for the user, which ends in a newline */
  EQM_MONITOR_END        /* status and message are final */
} EqmMonitorEvent;
/* A function that is called for such events; `context` is that of EqmSolverSetMonitor. Collective. */
typedef PetscErrorCode (*EqmMonitor)(EqmSolver solver, EqmMonitorEvent event, const char *text, void *context);
/* EqmSolverSetMonitor - call `monitor` as the solver gets on, on every rank; NULL (as created): nothing. The option
   -monitor sets EqmSolverMonitorText where there is none, -quiet takes any away. */
PETSC_EXTERN PetscErrorCode EqmSolverSetMonitor(EqmSolver solver, EqmMonitor monitor, void *context);
/* EqmSolverMonitorText - the program's text monitor: one line that is overwritten on a terminal, plain
   lines now and then elsewhere. `context` is not used. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverMonitorText(EqmSolver solver, EqmMonitorEvent event, const char *text,
                                                 void *context);

/* ---- solving */

/* EqmSolverSetUp - settle what was left open and make the first map; EqmSolverSolve does it if it has not been done.
   Collective. Errors: EQM_ERR_USAGE, EQM_ERR_MESH. */
PETSC_EXTERN PetscErrorCode EqmSolverSetUp(EqmSolver solver);
/* EqmSolverSolve - minimise, and unfold what can be unfolded. A conformal map of a closed surface by the default method
   that has folds or has jammed, or has triangles too small for their orientation to be computed safely, is made once
   more on the intrinsic Delaunay triangulation (docs/methods.md, Thin limbs). Never fails for want of convergence: the
   status tells. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverSolve(EqmSolver solver);
/* EqmSolverView - print what the solver is set to, and after EqmSolverSolve how it went. Collective on the viewer. */
PETSC_EXTERN PetscErrorCode EqmSolverView(EqmSolver solver, PetscViewer viewer);

/* ---- results */

/* EqmSolverGetStatus - how it ended, as a status and in words; either pointer may be NULL. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetStatus(EqmSolver solver, EqmStatus *status, const char **message);
/* EqmSolverGetMethod - the method's name. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetMethod(EqmSolver solver, const char **name);
/* EqmSolverGetIterationNumber - how many iterations were made so far. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetIterationNumber(EqmSolver solver, PetscInt *number);
/* EqmSolverGetTotals - energy, folds and other sums of the present map. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetTotals(EqmSolver solver, const EqmImageTotals **totals);
/* EqmSolverGetHistory - the rows so far, the first for the first map. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetHistory(EqmSolver solver, PetscInt *num_rows, const EqmHistoryRow **rows);
/* EqmSolverGetPlaces - the present map: coordinates per local vertex, ghosts included, which belong to the solver. Not
   collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetPlaces(EqmSolver solver, const EqmPlace **place);
/* EqmSolverGetDomain - the domain, which belongs to the solver. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetDomain(EqmSolver solver, EqmDomain *domain);
/* EqmSolverLandmarksReached - is every landmark closer to its place than the tolerance? Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverLandmarksReached(EqmSolver solver, PetscBool *reached);
/* EqmSolverGetMap - the present map in the numbering of `soup`, which must be the one that the mesh was made of and
   must outlive the map; with distortion, history and work. The map is the caller's to destroy. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetMap(EqmSolver solver, EqmSoup soup, EqmMap *map);
/* EqmSolverHelp - print (on rank 0) the options that EqmSolverSetFromOptions knows, without a mesh. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverHelp(MPI_Comm comm, const char *target);

/* EqmHessianAvailable - was the library built with SLEPc, which EqmSolverHessianEigenvalues needs? Not collective. */
PETSC_EXTERN PetscBool EqmHessianAvailable(void);
/* EqmSolverHessianEigenvalues - the `wanted` algebraically smallest eigenvalues of the Riemannian Hessian of the
   normalised authalic energy at the present map (001 Table 4), ascending; `found` tells how many converged. Errors:
   EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverHessianEigenvalues(EqmSolver solver, PetscInt wanted, PetscReal *values,
                                                        PetscInt *found);
/* EqmSolverStretchHessianEigenvalues - the same of the Hessian of 001 Appendix B, that of the stretch energy in space,
   for maps to the sphere. Errors: EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverStretchHessianEigenvalues(EqmSolver solver, PetscInt wanted, PetscReal *values,
                                                               PetscInt *found);

#endif
