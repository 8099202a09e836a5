/* The text monitor: one line that is overwritten on a terminal, plain lines at intervals in a log. */
#include "solver/solver_private.h"
#include <stdlib.h>
#include <unistd.h>

/* Plain lines come at most this often, in seconds, so that a batch log stays readable. */
static const PetscReal log_interval = 2.;

/* Under a launcher, ranks may have a pseudo-terminal although the launcher's output goes to a file: lines are plain
   there. */
static PetscBool OnTerminal(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"};

  for (size_t k = 0; k < sizeof(launchers) / sizeof(launchers[0]); k++) {
    if (getenv(launchers[k])) return PETSC_FALSE;
  }
  return (PetscBool)isatty(STDOUT_FILENO);
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

static PetscErrorCode ShowIteration(EqmSolver solver)
{
  const EqmHistoryRow *const row = &solver->history[solver->num_history - 1];

  PetscFunctionBegin;
  if (OnTerminal() || solver->num_history == 1 || row->seconds >= solver->last_shown + log_interval) {
    solver->last_shown = row->seconds;
    solver->rows_shown = solver->num_history;
    PetscCall(PrintRow(solver, row, PETSC_FALSE));
  }
  PetscFunctionReturn(0);
}

/* The last row, and why it is the last. */
static PetscErrorCode ShowEnd(EqmSolver solver)
{
  PetscFunctionBegin;
  if (solver->rows_shown < solver->num_history || OnTerminal())
    PetscCall(PrintRow(solver, &solver->history[solver->num_history - 1], PETSC_TRUE));
  PetscCall(PetscPrintf(solver->comm, "%s%s: %s\n", OnTerminal() ? "\n" : "", EqmStatusName(solver->status),
                        solver->message));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverMonitorText(EqmSolver solver, EqmMonitorEvent event, const char *text, void *context)
{
  PetscFunctionBegin;
  (void)context;
  switch (event) {
  case EQM_MONITOR_BEGIN: /* what solves with matrices, and the head line */
    if (text[0]) PetscCall(PetscPrintf(solver->comm, "linear solver: %s\n", text));
    PetscCall(PetscPrintf(solver->comm, "%9s  %12s  %11s  %6s  %8s  %9s  %s\n", "iteration", "energy", "SD", "folds",
                          "step", "elapsed", "at most"));
    break;
  case EQM_MONITOR_ITERATION:
    PetscCall(ShowIteration(solver));
    break;
  case EQM_MONITOR_NOTE:
    PetscCall(PetscPrintf(solver->comm, "%s", text));
    break;
  case EQM_MONITOR_END:
    PetscCall(ShowEnd(solver));
    break;
  }
  PetscFunctionReturn(0);
}
