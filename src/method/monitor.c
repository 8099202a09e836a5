/* What a user sees while it runs: one line that renews itself on a terminal, plain lines now and then in a log. */
#include "method/method.h"
#include <stdlib.h>
#include <unistd.h>

/* Plain lines come at most this often, in seconds, so that a batch log stays readable. */
static const PetscReal log_interval = 2.;

/* A launcher may hand its ranks a pseudo-terminal though its own output goes to a file: under one, lines are plain. */
static PetscBool OnTerminal(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"};

  for (size_t k = 0; k < sizeof(launchers) / sizeof(launchers[0]); k++) {
    if (getenv(launchers[k])) return PETSC_FALSE;
  }
  return (PetscBool)isatty(STDOUT_FILENO);
}

/* What solves with matrices, and the head line. Collective. */
PetscErrorCode EqmMonitorBegin(EqmSolver solver)
{
  PetscFunctionBegin;
  if (solver->settings.quiet) PetscFunctionReturn(0);
  if (solver->linear_solver[0]) PetscCall(PetscPrintf(solver->comm, "linear solver: %s\n", solver->linear_solver));
  PetscCall(PetscPrintf(solver->comm, "%9s  %12s  %11s  %6s  %8s  %9s  %s\n", "iteration", "energy", "SD", "folds",
                        "step", "elapsed", "at most"));
  PetscFunctionReturn(0);
}

static PetscErrorCode PrintRow(EqmSolver solver, const EqmHistoryRow *row, PetscBool last)
{
  const PetscInt left = solver->settings.max_it - row->iteration;
  const PetscReal begun = solver->history[0].seconds;
  const PetscReal remaining = row->iteration > 0 ? (row->seconds - begun) / row->iteration * left : 0.;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(solver->comm, "%s%9" PetscInt_FMT "  %12.5e  %11.4e  %6" PetscInt64_FMT "  %8.4f  %7.1f s",
                        OnTerminal() ? "\r" : "", row->iteration, (double)row->energy, (double)row->sd, row->folds,
                        (double)row->step, (double)row->seconds));
  if (row->iteration > 0 && left > 0 && !last) PetscCall(PetscPrintf(solver->comm, "  %.0f s more", (double)remaining));
  PetscCall(PetscPrintf(solver->comm, OnTerminal() ? "\033[K" : "\n"));
  PetscFunctionReturn(0);
}

/* Room for so many rows of the history. Not collective. */
PetscErrorCode EqmMonitorReserve(EqmSolver solver, PetscInt rows)
{
  PetscFunctionBegin;
  if (rows <= solver->most_history) PetscFunctionReturn(0);
  solver->most_history = PetscMax(PetscMax(64, 2 * solver->most_history), rows);
  PetscCall(PetscRealloc(sizeof(EqmHistoryRow) * (size_t)solver->most_history, &solver->history));
  PetscCall(PetscRealloc(sizeof(PetscReal) * (size_t)solver->most_history, &solver->objectives));
  PetscFunctionReturn(0);
}

/* Add a row to the history and show it. Collective. */
PetscErrorCode EqmMonitorRow(EqmSolver solver)
{
  EqmWork *work;
  EqmHistoryRow *row;

  PetscFunctionBegin;
  PetscCall(EqmMonitorReserve(solver, solver->num_history + 1));
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  solver->objectives[solver->num_history] = solver->objective;
  row = &solver->history[solver->num_history++];
  *row = (EqmHistoryRow){.iteration = solver->iteration,
                         .energy = solver->totals.energy,
                         .sd = solver->totals.sd,
                         .folds = solver->totals.folds,
                         .step = solver->step_length,
                         .gradient_norm = solver->gradient_norm,
                         .work = *work};
  PetscCall(EqmLedgerGetSeconds(solver->mesh->ledger, NULL, NULL, &row->seconds));
  if (solver->settings.quiet) PetscFunctionReturn(0);
  if (OnTerminal() || solver->num_history == 1 || row->seconds >= solver->last_shown + log_interval) {
    solver->last_shown = row->seconds;
    solver->rows_shown = solver->num_history;
    PetscCall(PrintRow(solver, row, PETSC_FALSE));
  }
  PetscFunctionReturn(0);
}

/* The last row, and why it is the last. Collective. */
PetscErrorCode EqmMonitorEnd(EqmSolver solver)
{
  PetscFunctionBegin;
  if (solver->settings.quiet) PetscFunctionReturn(0);
  if (solver->rows_shown < solver->num_history || OnTerminal()) {
    PetscCall(PrintRow(solver, &solver->history[solver->num_history - 1], PETSC_TRUE));
  }
  PetscCall(PetscPrintf(solver->comm, "%s%s: %s\n", OnTerminal() ? "\n" : "", EqmStatusName(solver->status),
                        solver->message));
  PetscFunctionReturn(0);
}

/* Folds before and after an unfolding. Collective. */
PetscErrorCode EqmMonitorUnfolded(EqmSolver solver, const char *when)
{
  PetscFunctionBegin;
  if (solver->settings.quiet) PetscFunctionReturn(0);
  PetscCall(PetscPrintf(solver->comm, "unfolding %s: %" PetscInt64_FMT " folded %s, %" PetscInt64_FMT " afterwards\n",
                        when, solver->unfolded_from, solver->mesh->cell_size == 4 ? "tetrahedra" : "triangles",
                        solver->unfolded_to));
  PetscFunctionReturn(0);
}
