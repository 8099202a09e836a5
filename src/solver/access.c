/* Setters and getters of a solver. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "solver/inner.h"
#include "store/map_private.h"

static PetscErrorCode CheckNotSetUp(EqmSolver solver, const char *what)
{
  PetscFunctionBegin;
  PetscCheck(!solver->is_set_up, solver->comm, PETSC_ERR_ORDER, "%s comes before EqmSolverSetUp and EqmSolverSolve",
             what);
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckSetUp(EqmSolver solver, const char *what)
{
  PetscFunctionBegin;
  PetscCheck(solver->is_set_up, solver->comm, PETSC_ERR_ORDER, "%s comes after EqmSolverSetUp or EqmSolverSolve", what);
  PetscFunctionReturn(0);
}

/* ---- settings */

PetscErrorCode EqmSolverSetOptionsPrefix(EqmSolver solver, const char *prefix)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(PetscStrncpy(solver->prefix, prefix ? prefix : "", sizeof(solver->prefix)));
  PetscFunctionReturn(0);
}

/* Undo EqmSolverResolveSettings: the options may have changed. */
PetscErrorCode EqmSolverSetMethod(EqmSolver solver, const char *name)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(PetscStrncpy(solver->settings.method, name, sizeof(solver->settings.method)));
  PetscCall(EqmMethodDestroy(&solver->method));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetStart(EqmSolver solver, const char *name)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(PetscStrncpy(solver->settings.start.name, name, sizeof(solver->settings.start.name)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetTolerances(EqmSolver solver, PetscReal energy_rtol, PetscReal ratio_tol,
                                      PetscReal gradient_tol, PetscInt max_it)
{
  EqmSolverSettings *const set = &solver->settings;

  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  if (energy_rtol != PETSC_DEFAULT) set->energy_rtol = energy_rtol;
  if (ratio_tol != PETSC_DEFAULT) set->ratio_tol = ratio_tol;
  if (gradient_tol != PETSC_DEFAULT) set->gradient_tol = gradient_tol;
  if (max_it != PETSC_DEFAULT) set->max_it = max_it;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetBalance(EqmSolver solver, PetscReal epsilon)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  solver->settings.balance = epsilon;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetBalanceEnergy(EqmSolver solver, PetscReal energy)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  solver->settings.balance_energy = energy;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetCorners(EqmSolver solver, const PetscInt corners[4])
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(PetscArraycpy(solver->settings.corners, corners, 4));
  solver->settings.has_corners = PETSC_TRUE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetFirstMap(EqmSolver solver, PetscInt dim, const PetscReal *x)
{
  const PetscInt length = dim * solver->mesh->num_owned;

  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(PetscFree(solver->first_map));
  PetscCall(PetscMalloc1(length + 1, &solver->first_map)); /* not NULL on ranks without vertices */
  PetscCall(PetscArraycpy(solver->first_map, x, length));
  solver->first_map_dim = dim;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetLandmarks(EqmSolver solver, PetscInt num, PetscInt dim, const PetscInt *vertices,
                                     const PetscReal *places, const PetscReal *weights, PetscReal lambda,
                                     PetscReal tolerance)
{
  PetscFunctionBegin;
  PetscCall(CheckNotSetUp(solver, PETSC_FUNCTION_NAME));
  PetscCall(EqmLandmarksGive(&solver->landmarks, num, dim, vertices, places, weights));
  solver->landmarks.lambda = lambda;
  solver->landmarks.tolerance = tolerance;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetMonitor(EqmSolver solver, EqmMonitor monitor, void *context)
{
  PetscFunctionBegin;
  solver->monitor = monitor;
  solver->monitor_context = context;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetInnerSteps(EqmSolver solver, PetscInt steps)
{
  PetscFunctionBegin;
  solver->settings.inner_steps = steps;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverIgnoreStopRequests(EqmSolver solver)
{
  PetscFunctionBegin;
  solver->checkpoints.ignores_requests = PETSC_TRUE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetStopFile(EqmSolver solver, const EqmStopFile *watch)
{
  PetscFunctionBegin;
  solver->checkpoints.stop_file = *watch;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSetKeptMesh(EqmSolver solver, const char *name)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(solver->checkpoints.kept_mesh, name, sizeof(solver->checkpoints.kept_mesh)));
  PetscFunctionReturn(0);
}

/* ---- results */

PetscErrorCode EqmSolverCheckpointFailed(EqmSolver solver, PetscBool *failed)
{
  PetscFunctionBegin;
  *failed = solver->checkpoints.failing;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetStatus(EqmSolver solver, EqmStatus *status, const char **message)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  if (status) *status = solver->status;
  if (message) *message = solver->message;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetMethod(EqmSolver solver, const char **name)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *name = solver->defaults.name;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetIterationNumber(EqmSolver solver, PetscInt *number)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *number = solver->iterate->number;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetTotals(EqmSolver solver, const EqmImageTotals **totals)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *totals = &solver->iterate->totals;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetHistory(EqmSolver solver, PetscInt *num_rows, const EqmHistoryRow **rows)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *num_rows = solver->num_history;
  *rows = solver->history;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetPlaces(EqmSolver solver, const EqmPlace **place)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *place = &solver->iterate->place;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetDomain(EqmSolver solver, EqmDomain *domain)
{
  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *domain = solver->problem->domain;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverLandmarksReached(EqmSolver solver, PetscBool *reached)
{
  const EqmProblem problem = solver->problem;
  PetscReal largest;

  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  *reached = PETSC_TRUE;
  if (problem->landmarks.num_total == 0) PetscFunctionReturn(0);
  PetscCall(EqmLandmarksLargest(&problem->landmarks, problem->domain, solver->iterate->place.x, &largest));
  *reached = (PetscBool)(largest <= problem->landmarks.tolerance);
  PetscFunctionReturn(0);
}

/* How the run went, copied into the map. */
static PetscErrorCode TakeHistory(EqmSolver solver, EqmMap map)
{
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  map->cost.work = *work;
  map->iterations = solver->iterate->number;
  map->num_history = solver->num_history;
  PetscCall(PetscMalloc1(solver->num_history, &map->history));
  PetscCall(PetscArraycpy(map->history, solver->history, solver->num_history));
  map->energy_initial = solver->history[0].energy;
  map->energy_final = solver->iterate->totals.energy;
  map->status = solver->status;
  map->poor = solver->poor;
  map->num_boundary_vertices = solver->mesh->num_boundary_vertices;
  map->cost.ranks = solver->mesh->size;
  PetscCall(PetscStrncpy(map->message, solver->message, sizeof(map->message)));
  PetscCall(PetscStrncpy(map->method, solver->defaults.name, sizeof(map->method)));
  PetscCall(PetscStrncpy(map->linear_solver, solver->problem->linear_solver, sizeof(map->linear_solver)));
  PetscCall(PetscStrncpy(map->command, solver->target, sizeof(map->command)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetMap(EqmSolver solver, EqmSoup soup, EqmMap *map)
{
  EqmDomain domain;
  const EqmPlace *place;

  PetscFunctionBegin;
  PetscCall(CheckSetUp(solver, PETSC_FUNCTION_NAME));
  domain = solver->problem->domain;
  place = &solver->iterate->place;
  PetscCall(EqmMapCreate(soup, domain->dim, map));
  PetscCall(EqmMeshVerticesToInput(solver->mesh, soup, domain->dim, place->x, (*map)->coordinates));
  PetscCall(EqmMapMeasure(*map, solver->mesh, place->x));
  if (solver->mesh->cell_size == 4) PetscCall(EqmImageBoundaryFolds(domain, place, &(*map)->boundary_folds));
  PetscCall(TakeHistory(solver, *map));
  PetscFunctionReturn(0);
}
