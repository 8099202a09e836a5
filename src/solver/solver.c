/* A solver's life: created, set up, solved. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "solver/inner.h"
#include "solver/judge.h"
#include <string.h>

PetscErrorCode EqmSolverCreate(EqmMesh mesh, const char *target, EqmSolver *out)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(EqmMethodRegisterAll());
  PetscCall(PetscNew(&solver));
  solver->comm = mesh->comm;
  solver->mesh = mesh;
  PetscCall(PetscStrncpy(solver->target, target, sizeof(solver->target)));
  PetscCall(EqmSolverSettingsDefault(&solver->settings));
  PetscCall(EqmFormulationFind(solver->comm, target, mesh, &solver->formulation));
  *out = solver;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverDestroy(EqmSolver *solver)
{
  EqmSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(0);
  PetscCall(EqmMethodDestroy(&s->method));
  PetscCall(EqmIterateDestroy(&s->iterate));
  PetscCall(EqmProblemDestroy(&s->problem));
  PetscCall(EqmLandmarksReset(&s->landmarks));
  PetscCall(PetscFree(s->objectives));
  PetscCall(PetscFree(s->history));
  PetscCall(PetscFree(s->first_map));
  EqmLockRelease(&s->checkpoints.lock);
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(0);
}

/* ---- a solver inside the solver: the surface of a solid is mapped to the sphere, with options of its own */

/* The solid's fixed-point iteration begins with the surface's (003 Algorithm 1). */
static PetscErrorCode SetSurfaceDefaults(EqmSolver solver, EqmSolver sphere)
{
  const PetscBool by_fixed_point = (PetscBool)!strcmp(solver->defaults.name, "fixed-point");
  PetscBool limited;

  PetscFunctionBegin;
  PetscCall(EqmSolverSetOptionsPrefix(sphere, EQM_BOUNDARY_PREFIX));
  PetscCall(EqmSolverSetTolerances(sphere, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, by_fixed_point ? 10 : 60));
  if (by_fixed_point) PetscCall(EqmSolverSetMethod(sphere, solver->defaults.name));
  sphere->settings.unfolding = solver->settings.unfolding;
  PetscCall(PetscOptionsHasName(NULL, EQM_BOUNDARY_PREFIX, "-max_it", &limited));
  if (!by_fixed_point && !limited) /* a longer run would amplify rounding errors of the input */
    PetscCall(EqmSolverSetTolerances(sphere, PETSC_DEFAULT, .01, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(EqmSolverIgnoreStopRequests(sphere));
  PetscFunctionReturn(0);
}

static PetscErrorCode MapSurface(void *context, EqmMesh surface, PetscReal *x, PetscInt64 *folds)
{
  const EqmSolver solver = context;
  EqmSolver sphere;

  PetscFunctionBegin;
  PetscCall(EqmSolverCreate(surface, "sphere", &sphere));
  PetscCall(SetSurfaceDefaults(solver, sphere));
  PetscCall(EqmSolverSetFromOptions(sphere));
  PetscCall(EqmSolverSolve(sphere));
  PetscCall(PetscArraycpy(x, sphere->iterate->place.x, 3 * surface->num_local));
  *folds = sphere->iterate->totals.folds;
  PetscCall(EqmSolverDestroy(&sphere));
  PetscFunctionReturn(0);
}

/* ---- set-up */

static PetscErrorCode StopRequested(void *context, PetscBool *stop)
{
  PetscFunctionBegin;
  PetscCall(EqmCheckpointStopRequested(context, stop));
  PetscFunctionReturn(0);
}

static PetscErrorCode CreateProblem(EqmSolver solver)
{
  const EqmSolverSettings *const set = &solver->settings;
  EqmDomainOptions options = {.corners = set->has_corners ? set->corners : NULL,
                              .boundary_angles = set->boundary_angles[0] ? set->boundary_angles : NULL};
  PetscReal *angles, *places;
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(EqmSolverHeldAngles(solver, &angles));
  PetscCall(EqmSolverBoundaryPlaces(solver, MapSurface, &places));
  options.held_angles = angles;
  options.cube_places = places;
  PetscCall(EqmDomainCreate(solver->mesh,
                            solver->defaults.domain ? solver->defaults.domain : solver->formulation->domain, &options,
                            &domain));
  PetscCall(PetscFree(angles));
  PetscCall(PetscFree(places));
  PetscCall(EqmProblemCreate(domain, solver->objective, &solver->problem));
  solver->problem->unfolding = (EqmUnfolding)set->unfolding;
  PetscCall(PetscStrncpy(solver->problem->prefix, solver->prefix, sizeof(solver->problem->prefix)));
  solver->problem->notify = EqmSolverNotify;
  solver->problem->stop_requested = StopRequested;
  solver->problem->context = solver;
  PetscCall(EqmIterateCreate(solver->problem, &solver->iterate));
  PetscFunctionReturn(0);
}

/* What the objective has beside its leading term, for methods that minimise it. */
static PetscErrorCode AddTerms(EqmSolver solver)
{
  const EqmProblem problem = solver->problem;
  EqmTerm term;

  PetscFunctionBegin;
  if (!solver->method->takes_terms) PetscFunctionReturn(0);
  if (solver->settings.balance > 0.) {
    PetscCall(EqmTermCreateAngle(problem, solver->settings.balance, &term));
    PetscCall(EqmProblemAddTerm(problem, term));
  }
  if (problem->landmarks.num_total > 0) {
    PetscCall(EqmTermCreateLandmarks(problem, problem->landmarks.lambda, &term));
    PetscCall(EqmProblemAddTerm(problem, term));
  }
  PetscFunctionReturn(0);
}

/* ---- set-up */

PetscErrorCode EqmSolverSetUp(EqmSolver solver)
{
  const EqmLedger ledger = solver->mesh->ledger;

  PetscFunctionBegin;
  if (solver->is_set_up) PetscFunctionReturn(0);
  PetscCall(EqmSolverResolveSettings(solver));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_START));
  PetscCall(CreateProblem(solver));
  PetscCall(EqmCheckpointBegin(solver));
  solver->problem->landmarks = solver->landmarks; /* the problem owns the arrays from here on */
  solver->landmarks = (EqmLandmarks){0};
  solver->is_set_up = PETSC_TRUE;
  if (solver->settings.restart[0])
    PetscCall(EqmCheckpointLoadMap(solver));
  else
    PetscCall(EqmSolverMakeFirstMap(solver));
  if (solver->problem->landmarks.num_total > 0) PetscCall(EqmSolverCheckLandmarkSupport(solver));
  PetscCall(EqmLandmarksSetUp(&solver->problem->landmarks, solver->problem->domain));
  PetscCall(AddTerms(solver));
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_START));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSolve(EqmSolver solver)
{
  PetscBool blocked;

  PetscFunctionBegin;
  PetscCall(EqmSolverSetUp(solver));
  blocked = EqmSolverIsBlocked(solver);
  if (!blocked) PetscCall(EqmSolverRun(solver));
  PetscCall(EqmSolverTryAgain(solver));
  if (blocked && solver->iterate->totals.folds > 0) PetscCall(EqmSolverRun(solver)); /* which says so */
  PetscCall(EqmJudgePoor(solver));
  PetscCall(EqmSolverCallMonitor(solver, EQM_MONITOR_END, solver->message));
  PetscCall(EqmSolverStraighten(solver));
  PetscFunctionReturn(0);
}
