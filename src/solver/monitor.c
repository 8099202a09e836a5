/* The text monitor: one line that is overwritten on a terminal, plain lines at intervals in a log. */
#include "solver/solver_private.h"
#include "base/progress.h"

/* Plain lines come at most this often, in seconds, so that a batch log stays readable. */
static const PetscReal log_interval = 2.;

/* Of the last iterations: how many tell what the next ones will be like. */
enum { RECENT = 5 };

/* How many iterations may still come: up to -max_it, or until the energy, falling as it did of late, is at its target.
 */
static PetscReal IterationsLeft(EqmSolver solver, PetscInt recent)
{
  const EqmSolverSettings *const set = &solver->settings;
  const EqmHistoryRow *const now = &solver->history[solver->num_history - 1], *const then = now - recent;
  const PetscReal by_ratio = set->ratio_tol > 0. ? PetscSqr(set->ratio_tol) * solver->iterate->totals.total : 0.;
  const PetscReal target = PetscMax(by_ratio, set->energy_target), left = set->max_it - now->iteration;

  if (target > 0. && now->energy <= target) return 0.;
  if (!(target > 0.) || !(then->energy > now->energy)) return left;
  return PetscMin(left, PetscCeilReal(recent * PetscLogReal(now->energy / target) /
                                      PetscLogReal(then->energy / now->energy)));
}

static PetscErrorCode PrintRow(EqmSolver solver, const EqmHistoryRow *row, PetscBool last)
{
  const PetscInt recent = PetscMin(RECENT, solver->num_history - 1);
  const PetscReal left = recent > 0 ? IterationsLeft(solver, recent) : 0.;
  const PetscReal each = recent > 0 ? (row->seconds - row[-recent].seconds) / recent : 0.;

  PetscFunctionBegin;
  PetscCall(PetscPrintf(solver->comm, "%s%9" PetscInt_FMT "  %12.5e  %11.4e  %6" PetscInt64_FMT "  %8.4f  %7.1f s",
                        EqmOnTerminal() ? "\r" : "", row->iteration, (double)row->energy, (double)row->sd, row->folds,
                        (double)row->step, (double)row->seconds));
  if (left > 0. && !last) PetscCall(PetscPrintf(solver->comm, "  %7.0f s", (double)(left * each)));
  PetscCall(PetscPrintf(solver->comm, EqmOnTerminal() ? "\033[K" : "\n"));
  PetscFunctionReturn(0);
}

static PetscErrorCode ShowIteration(EqmSolver solver)
{
  const EqmHistoryRow *const row = &solver->history[solver->num_history - 1];

  PetscFunctionBegin;
  if (EqmOnTerminal() || solver->num_history == 1 || row->seconds >= solver->last_shown + log_interval) {
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
  if (solver->rows_shown < solver->num_history || EqmOnTerminal())
    PetscCall(PrintRow(solver, &solver->history[solver->num_history - 1], PETSC_TRUE));
  PetscCall(PetscPrintf(solver->comm, "%s%s: %s\n", EqmOnTerminal() ? "\n" : "", EqmStatusName(solver->status),
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
                          "step", "elapsed", "remaining"));
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
