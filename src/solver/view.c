/* Print a solver's settings and result. */
#include "solver/solver_private.h"

static PetscErrorCode ViewResult(EqmSolver solver, PetscViewer viewer)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "linear solver: %s\n", solver->problem->linear_solver));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "after %" PetscInt_FMT " iterations: energy %.6g, %" PetscInt64_FMT " folds\n",
                                   solver->iterate->number, (double)totals->energy, totals->folds));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %s\n", EqmStatusName(solver->status), solver->message));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverView(EqmSolver solver, PetscViewer viewer)
{
  const EqmSolverSettings *const set = &solver->settings;

  PetscFunctionBegin;
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(solver->comm, &viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "EqmSolver: %s to the %s\n", solver->target, solver->formulation->domain));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  if (solver->method) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "method: %s (%s)\n", solver->defaults.name, solver->method->purpose));
    PetscCall(PetscViewerASCIIPrintf(viewer, "first map: %s\n",
                                     solver->first_map ? "given"
                                     : solver->start   ? solver->start->name
                                                       : "not settled"));
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "at most %" PetscInt_FMT
                                     " iterations; tolerances: energy %.6g per iteration, ratios %.6g, gradient %.6g\n",
                                     set->max_it, (double)set->energy_rtol, (double)set->ratio_tol,
                                     (double)set->gradient_tol));
  } else {
    PetscCall(PetscViewerASCIIPrintf(viewer, "method: %s\n", set->method));
  }
  if (solver->num_history > 0) PetscCall(ViewResult(solver, viewer));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(0);
}
