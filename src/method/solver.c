/* The loop that all methods share: start, iterate, judge, stop. */
#include "method/method.h"
#include "store/map_private.h"
#include <string.h>

PetscErrorCode EqmSolverCreate(EqmMesh mesh, const char *target, EqmSolver *out)
{
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(PetscNew(&solver));
  solver->comm = mesh->comm;
  solver->mesh = mesh;
  PetscCall(PetscStrncpy(solver->target, target, sizeof(solver->target)));
  PetscCall(EqmSettingsDefault(&solver->settings));
  PetscCall(EqmProblemFind(solver->comm, target, mesh, &solver->problem));
  *out = solver;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverDestroy(EqmSolver *solver)
{
  EqmSolver s = *solver;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(0);
  PetscCall(EqmLinearDestroy(&s->scalar));
  PetscCall(EqmOrderingDestroy(&s->ordering));
  PetscCall(PetscFree(s->scalar_count));
  PetscCall(EqmPlaceDestroy(&s->place));
  PetscCall(PetscFree(s->image));
  PetscCall(PetscFree(s->angle_weights));
  PetscCall(PetscFree(s->vertex_mass));
  PetscCall(PetscFree(s->objectives));
  PetscCall(PetscFree(s->history));
  PetscCall(PetscFree(s->first_map));
  PetscCall(EqmLandmarksReset(&s->landmarks));
  PetscCall(EqmDomainDestroy(&s->domain));
  PetscCall(PetscFree(*solver));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverLook(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(solver->domain, &solver->place, solver->image));
  PetscCall(EqmSolverSum(solver));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSum(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(solver->problem->objective->sum(solver));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverAccept(EqmSolver solver, const EqmPlace *trial, const PetscReal *image, PetscReal objective,
                               PetscReal step_length)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceCopy(solver->domain, trial, &solver->place));
  PetscCall(PetscArraycpy(solver->image, image, solver->mesh->num_local_cells));
  PetscCall(EqmSolverSum(solver));
  solver->objective = objective;
  solver->step_length = step_length;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverBegin(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(mesh->ledger, EQM_PHASE_START));
  PetscCall(solver->problem->create_domain(solver, &solver->domain));
  PetscCall(EqmOrderingCreate(mesh, &solver->ordering));
  PetscCall(EqmPlaceCreate(solver->domain, &solver->place));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &solver->image));
  PetscCall(EqmCheckpointBegin(solver));
  PetscCall(EqmSolverTakeGiven(solver));
  PetscCall(EqmSolverLook(solver));
  PetscCall(EqmPhaseEnd(mesh->ledger, EQM_PHASE_START));
  PetscFunctionReturn(0);
}

/* Has the objective all but stopped falling over the last iterations? */
static PetscBool Stagnates(EqmSolver solver)
{
  const PetscInt last = solver->num_history - 1, span = solver->settings.stagnation;

  if (last < span) return PETSC_FALSE;
  const PetscReal then = solver->objectives[last - span], now = solver->objectives[last];
  return (PetscBool)(solver->settings.energy_rtol > 0. &&
                     then - now <= span * solver->settings.energy_rtol * PetscAbsReal(then));
}

/* The method has come to its end, but the map may be none of equal areas. */
static PetscErrorCode DoubtStandstill(EqmSolver solver)
{
  const PetscReal poor = solver->problem->objective->poor_energy;

  PetscFunctionBegin;
  if (poor == 0. || solver->totals.energy <= poor * solver->totals.total) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscStrlcat(solver->message,
                         ", far from equal areas: the target may not suit the mesh (corners? slivers?)",
                         sizeof(solver->message)));
  PetscFunctionReturn(0);
}

/* Is there reason to stop? Says which in status and message. The clock is rank 0's, so that all ranks agree. */
static PetscErrorCode ShouldStop(EqmSolver solver, PetscBool *stop)
{
  const EqmSettings *const set = &solver->settings;
  PetscBool reached;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmSolverLandmarksReached(solver, &reached));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  *stop = PETSC_TRUE;
  solver->status = EQM_STATUS_CONVERGED;
  if (reached && set->energy_target > 0. && solver->totals.energy <= set->energy_target) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "the energy has reached its target %g",
                            (double)set->energy_target));
  } else if (reached && set->ratio_tol > 0. &&
             solver->totals.energy <= PetscSqr(set->ratio_tol) * solver->totals.total) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "the ratios are within %g of one, root mean square", (double)set->ratio_tol));
  } else if (solver->gradient_norm >= 0. && solver->gradient_norm <= set->gradient_tol) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "the gradient's norm is below %g",
                            (double)set->gradient_tol));
  } else if (Stagnates(solver)) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "the objective fell by less than %g %% per iteration over the last %" PetscInt_FMT
                            " iterations",
                            100. * (double)set->energy_rtol, set->stagnation));
    PetscCall(DoubtStandstill(solver));
  } else {
    solver->status = EQM_STATUS_NOT_CONVERGED;
    if (solver->iteration >= set->max_it) {
      PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                              "stopped after -max_it %" PetscInt_FMT " iterations", set->max_it));
    } else if (set->max_factorizations > 0 && work->coupled_factorizations >= set->max_factorizations) {
      PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                              "stopped after -max_factorizations %" PetscInt_FMT, set->max_factorizations));
    } else {
      PetscCall(EqmCheckpointAskedToStop(solver, stop));
    }
  }
  PetscFunctionReturn(0);
}

/* The method has no further step. It may have said why. */
static PetscErrorCode Finish(EqmSolver solver, EqmStep outcome)
{
  PetscFunctionBegin;
  solver->checkpoints.finished = PETSC_TRUE;
  if (outcome == EQM_STEP_CONVERGED) {
    solver->status = EQM_STATUS_CONVERGED;
    if (!solver->message[0])
      PetscCall(PetscStrncpy(solver->message, "the next step would change the objective by rounding only",
                             sizeof(solver->message)));
    PetscCall(DoubtStandstill(solver));
  } else {
    solver->status = EQM_STATUS_NOT_CONVERGED;
    if (!solver->message[0])
      PetscCall(PetscStrncpy(solver->message,
                             "no step decreases the objective any more: the limit of this method and this arithmetic",
                             sizeof(solver->message)));
  }
  PetscFunctionReturn(0);
}

/* The method is ready for its first step, or for the next one of a run that was interrupted. */
static PetscErrorCode SetUp(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(solver->method->set_up(solver));
  PetscCall(EqmMonitorBegin(solver));
  if (solver->checkpoints.open)
    PetscCall(EqmCheckpointLoadMethod(solver));
  else
    PetscCall(EqmMonitorRow(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode Iterate(EqmSolver solver)
{
  PetscBool stop = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(SetUp(solver));
  if (!solver->checkpoints.finished) PetscCall(ShouldStop(solver, &stop));
  while (!stop && !solver->checkpoints.finished) {
    EqmStep outcome;
    PetscCall(EqmCheckpointIfDue(solver));
    PetscCall(solver->method->step(solver, &outcome));
    if (outcome != EQM_STEP_TAKEN) {
      PetscCall(Finish(solver, outcome));
      break;
    }
    solver->iteration++;
    PetscCheck(!PetscIsInfOrNanReal(solver->totals.energy), solver->comm, PETSC_ERR_FP,
               "the energy is not finite after iteration %" PetscInt_FMT, solver->iteration);
    PetscCall(EqmMonitorRow(solver));
    PetscCall(ShouldStop(solver, &stop));
  }
  PetscCall(EqmCheckpointEnd(solver));
  PetscCall(solver->method->destroy(solver));
  PetscFunctionReturn(0);
}

/* A map with folds is no success, wherever they are. */
static PetscErrorCode JudgeFolds(EqmSolver solver)
{
  const EqmOffer *const offer = &solver->problem->offers[0];
  const PetscBool solid = (PetscBool)(solver->mesh->cell_size == 4);
  const PetscBool is_default =
      (PetscBool)(solver->method == offer->method && !strcmp(solver->settings.start, offer->start));
  PetscInt64 on_boundary = 0;

  PetscFunctionBegin;
  if (solid) PetscCall(EqmImageBoundaryFolds(solver->domain, &solver->place, &on_boundary));
  if (solver->totals.folds == 0 && on_boundary == 0) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_FOLDS;
  PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "%" PetscInt64_FMT " %s of the map are folded over",
                          solver->totals.folds, solid ? "tetrahedra" : "triangles"));
  if (solid) {
    PetscCall(PetscSNPrintf(solver->message + strlen(solver->message),
                            sizeof(solver->message) - strlen(solver->message),
                            ", and %" PetscInt64_FMT
                            " triangles of its boundary; where `check` finds interior edges between boundary vertices, "
                            "-repair splits them, which helps; else",
                            on_boundary));
  } else {
    PetscCall(PetscStrlcat(solver->message, ";", sizeof(solver->message)));
  }
  PetscCall(PetscStrlcat(solver->message,
                         is_default ? " cells of a better shape, or finer ones, may help"
                                    : " try the default method and its start",
                         sizeof(solver->message)));
  PetscFunctionReturn(0);
}

/* The problem's last touch, and folds mended if that can be done. */
static PetscErrorCode End(EqmSolver solver)
{
  PetscBool stop = PETSC_FALSE;

  PetscFunctionBegin;
  if (solver->problem->finish) PetscCall(solver->problem->finish(solver));
  if (solver->problem->unfold && solver->totals.folds > 0) PetscCall(EqmCheckpointAskedToStop(solver, &stop));
  if (solver->problem->unfold && solver->totals.folds > 0 && !stop) {
    PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_MINIMISE));
    PetscCall(solver->problem->unfold(solver, &solver->unfolded_from, &solver->unfolded_to));
    PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_MINIMISE));
    PetscCall(EqmSolverLook(solver));
    PetscCall(EqmMonitorUnfolded(solver, "at the end"));
  }
  if (solver->status != EQM_STATUS_STOPPED) PetscCall(JudgeFolds(solver));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverSolve(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverBegin(solver));
  if (solver->unfolded_from > 0 && !solver->checkpoints.open) PetscCall(EqmMonitorUnfolded(solver, "at the start"));
  PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  PetscCall(Iterate(solver));
  PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  if (solver->status != EQM_STATUS_STOPPED) PetscCall(End(solver));
  PetscCall(EqmMonitorEnd(solver));
  PetscFunctionReturn(0);
}

/* How the run went, copied into the map. */
static PetscErrorCode TakeHistory(EqmSolver solver, EqmMap map)
{
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  map->cost.work = *work;
  map->iterations = solver->iteration;
  map->num_history = solver->num_history;
  PetscCall(PetscMalloc1(solver->num_history, &map->history));
  PetscCall(PetscArraycpy(map->history, solver->history, solver->num_history));
  map->energy_initial = solver->history[0].energy;
  map->energy_final = solver->totals.energy;
  map->status = solver->status;
  map->num_boundary_vertices = solver->mesh->num_boundary_vertices;
  map->cost.ranks = solver->mesh->size;
  PetscCall(PetscStrncpy(map->message, solver->message, sizeof(map->message)));
  PetscCall(PetscStrncpy(map->method, solver->method->name, sizeof(map->method)));
  PetscCall(PetscStrncpy(map->linear_solver, solver->linear_solver, sizeof(map->linear_solver)));
  PetscCall(PetscStrncpy(map->command, solver->target, sizeof(map->command)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetMap(EqmSolver solver, EqmSoup soup, EqmMap *map)
{
  PetscFunctionBegin;
  PetscCall(EqmMapCreate(soup, solver->domain->dim, map));
  PetscCall(EqmMeshVerticesToInput(solver->mesh, soup, solver->domain->dim, solver->place.x, (*map)->coordinates));
  PetscCall(EqmMapMeasure(*map, solver->mesh, solver->place.x));
  if (solver->mesh->cell_size == 4)
    PetscCall(EqmImageBoundaryFolds(solver->domain, &solver->place, &(*map)->boundary_folds));
  PetscCall(TakeHistory(solver, *map));
  PetscFunctionReturn(0);
}
