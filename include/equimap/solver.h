/* From a mesh and a target to a map: the start, the loop that all methods share, the end. */
#ifndef EQUIMAP_SOLVER_H
#define EQUIMAP_SOLVER_H

#include <equimap/energy.h>
#include <equimap/map.h>

typedef struct _p_EqmSolver *EqmSolver;

/* A solver for maps of `mesh` to `target`: "disk" or "square". Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverCreate(EqmMesh mesh, const char *target, EqmSolver *solver);
/* Read the options -method, -start, -max_it, -energy_rtol, -energy_target, -gradient_tol, -wall_time, -balance, -quiet
   and those of the method; with -help in the options database, print them. Errors: EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverSetFromOptions(EqmSolver solver);
/* Begin with the map that has the given places (of the target, `dim` coordinates per owned vertex) in place of -start.
   `x` is copied. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverSetFirstMap(EqmSolver solver, PetscInt dim, const PetscReal *x);
/* Draw vertices (input numbers, `num` of them, the same lists on every rank) towards places of the target, `dim`
   coordinates each: the objective gets the term lambda sum |x(v_i) - q_i|^2 (000 (46), 001 section 6.6), and the map is
   not done before each is closer than `tolerance`. The lists are copied. Not collective. */
PETSC_EXTERN PetscErrorCode EqmSolverSetLandmarks(EqmSolver solver, PetscInt num, PetscInt dim,
                                                  const PetscInt *vertices, const PetscReal *places, PetscReal lambda,
                                                  PetscReal tolerance);
/* Minimise. Never fails for want of convergence: the map's status tells. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverSolve(EqmSolver solver);
/* A conformal map of a closed surface by the default method that has folds or has jammed, or has triangles too small
   for their orientation to be computed safely, is made once more on the intrinsic Delaunay triangulation of `soup`,
   which must be the one that the mesh was made of. Nothing happens where all is well. Call after EqmSolverSolve.
   Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverStraighten(EqmSolver solver, EqmSoup soup);
/* The present map in the numbering of `soup`, which must be the one that the mesh was made of and must outlive the map;
   with distortion, history and work. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverGetMap(EqmSolver solver, EqmSoup soup, EqmMap *map);
PETSC_EXTERN PetscErrorCode EqmSolverDestroy(EqmSolver *solver);
/* Print (on rank 0) the options that EqmSolverSetFromOptions knows, without a mesh. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverHelp(MPI_Comm comm, const char *target);

/* Was the library built with SLEPc, which EqmSolverHessianEigenvalues needs? Not collective. */
PETSC_EXTERN PetscBool EqmHessianAvailable(void);
/* The `wanted` algebraically smallest eigenvalues of the Riemannian Hessian of the normalised authalic energy at the
   present map (001 Table 4), ascending; `found` tells how many converged. Errors: EQM_ERR_USAGE. Collective. */
PETSC_EXTERN PetscErrorCode EqmSolverHessianEigenvalues(EqmSolver solver, PetscInt wanted, PetscReal *values,
                                                        PetscInt *found);

#endif
