/* What a solver is given from outside: the first map, landmarks. */
#include "method/method.h"

PetscErrorCode EqmSolverSetFirstMap(EqmSolver solver, PetscInt dim, const PetscReal *x)
{
  const PetscInt length = dim * solver->mesh->num_owned;

  PetscFunctionBegin;
  PetscCall(PetscFree(solver->first_map));
  PetscCall(PetscMalloc1(length + 1, &solver->first_map)); /* not NULL on ranks without vertices */
  PetscCall(PetscArraycpy(solver->first_map, x, length));
  solver->first_map_dim = dim;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetLandmarks(EqmSolver solver, PetscInt num, PetscInt dim, const PetscInt *vertices,
                                     const PetscReal *places, PetscReal lambda, PetscReal tolerance)
{
  PetscFunctionBegin;
  PetscCall(EqmLandmarksGive(&solver->landmarks, num, dim, vertices, places));
  solver->landmarks.lambda = lambda;
  solver->landmarks.tolerance = tolerance;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverCheckDraws(EqmSolver solver)
{
  PetscFunctionBegin;
  if (!solver->method->takes_landmarks)
    EqmFail(solver->comm, EQM_ERR_USAGE, "-method %s cannot draw landmarks together; take lm", solver->method->name);
  PetscFunctionReturn(0);
}

/* The first map, given or made, or the map of a checkpoint, and the landmarks' owners. Collective. */
PetscErrorCode EqmSolverTakeGiven(EqmSolver solver)
{
  const EqmDomain domain = solver->domain;

  PetscFunctionBegin;
  if (solver->settings.restart[0]) {
    PetscCall(EqmCheckpointLoadMap(solver));
  } else if (solver->first_map) {
    PetscCheck(solver->first_map_dim == domain->dim, solver->comm, PETSC_ERR_ARG_INCOMP,
               "a first map has the target's coordinates");
    PetscCall(PetscArraycpy(solver->place.x, solver->first_map, domain->dim * solver->mesh->num_owned));
    PetscCall(EqmMeshUpdateGhosts(solver->mesh, domain->dim, solver->place.x));
    PetscCall(EqmPlaceMakeFrames(domain, &solver->place));
  } else {
    PetscCall(EqmStart(solver));
  }
  if (solver->landmarks.num_total > 0) PetscCall(EqmSolverCheckDraws(solver));
  PetscCall(EqmLandmarksSetUp(&solver->landmarks, domain));
  PetscFunctionReturn(0);
}

/* Are the landmarks where they should be? Collective. */
PetscErrorCode EqmSolverLandmarksReached(EqmSolver solver, PetscBool *reached)
{
  PetscReal largest;

  PetscFunctionBegin;
  *reached = PETSC_TRUE;
  if (solver->landmarks.num_total == 0) PetscFunctionReturn(0);
  PetscCall(EqmLandmarksLargest(&solver->landmarks, solver->domain, solver->place.x, &largest));
  *reached = (PetscBool)(largest <= solver->landmarks.tolerance);
  PetscFunctionReturn(0);
}
