/* The history of a run, and the calls of the monitor. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include "problem/objective.h"

PetscErrorCode EqmHistoryReserve(EqmSolver solver, PetscInt rows)
{
  PetscFunctionBegin;
  if (rows <= solver->max_history) PetscFunctionReturn(0);
  solver->max_history = PetscMax(PetscMax(64, 2 * solver->max_history), rows);
  PetscCall(PetscRealloc(sizeof(EqmHistoryRow) * (size_t)solver->max_history, &solver->history));
  PetscCall(PetscRealloc(sizeof(PetscReal) * (size_t)solver->max_history, &solver->objectives));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHistoryAddRow(EqmSolver solver)
{
  const EqmIterate iterate = solver->iterate;
  const EqmImageTotals *const totals = &iterate->totals;
  const PetscBool is_area = (PetscBool)(solver->problem->objective != &EqmObjectiveConformal);
  EqmWork *work;
  EqmHistoryRow *row;

  PetscFunctionBegin;
  PetscCheck(!PetscIsInfOrNanReal(totals->energy + totals->sd + totals->total), solver->comm, PETSC_ERR_FP,
             "the energy is not finite after iteration %" PetscInt_FMT, iterate->number);
  PetscCall(EqmHistoryReserve(solver, solver->num_history + 1));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  solver->objectives[solver->num_history] = iterate->objective;
  row = &solver->history[solver->num_history++];
  *row = (EqmHistoryRow){.iteration = iterate->number,
                         .energy = iterate->totals.energy,
                         .sd = iterate->totals.sd,
                         .folds = iterate->totals.folds,
                         .step = iterate->step_length,
                         .gradient_norm = iterate->gradient_norm,
                         .work = *work,
                         .stretch = is_area ? totals->energy + totals->total : -1.,
                         .image_measure = totals->total,
                         .preconditioned_norm = iterate->figures.preconditioned_norm,
                         .wolfe_decrease = iterate->figures.wolfe_decrease,
                         .wolfe_slope = iterate->figures.wolfe_slope,
                         .change = iterate->figures.change,
                         .phase = iterate->figures.phase,
                         .unfolded_from = iterate->unfolded_from};
  PetscCall(EqmLedgerGetSeconds(solver->mesh->ledger, NULL, NULL, &row->seconds));
  PetscCall(EqmSolverCallMonitor(solver, EQM_MONITOR_ITERATION, ""));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverCallMonitor(EqmSolver solver, EqmMonitorEvent event, const char *text)
{
  PetscFunctionBegin;
  if (solver->monitor && !solver->settings.quiet)
    PetscCall(solver->monitor(solver, event, text, solver->monitor_context));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverNotify(void *context, const char *text)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverCallMonitor(context, EQM_MONITOR_NOTE, text));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverNotifyUnfolded(EqmSolver solver, const char *when)
{
  const EqmIterate iterate = solver->iterate;

  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem,
                             "unfolding %s: %" PetscInt64_FMT " folded %s, %" PetscInt64_FMT " afterwards\n", when,
                             iterate->unfolded_from, solver->mesh->cell_size == 4 ? "tetrahedra" : "triangles",
                             iterate->unfolded_to));
  PetscFunctionReturn(0);
}
