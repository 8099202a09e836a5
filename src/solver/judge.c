#include "solver/judge.h"
#include "solver/mend.h"
#include "mesh/mesh_private.h"
#include <string.h>

/* Is the decrease of the objective over the last iterations below -energy_rtol? */
static PetscBool Stagnates(EqmSolver solver)
{
  const PetscInt last = solver->num_history - 1, span = solver->settings.stagnation;

  if (last < solver->begun_again + span) return PETSC_FALSE;
  const PetscReal then = solver->objectives[last - span], now = solver->objectives[last];
  return (PetscBool)(solver->settings.energy_rtol > 0. &&
                     then - now <= span * solver->settings.energy_rtol * PetscAbsReal(then));
}

/* Has it fallen by no more than the absolute tolerance in the last iteration (001 Algorithm 2 and 003 Algorithm 1 end
 * so)? */
static PetscBool StandsStill(EqmSolver solver)
{
  const PetscInt last = solver->num_history - 1;

  if (last < 1 || !(solver->settings.energy_atol > 0.)) return PETSC_FALSE;
  return (PetscBool)(solver->objectives[last - 1] - solver->objectives[last] <= solver->settings.energy_atol);
}

PetscReal EqmJudgePoorEnergy(EqmSolver solver)
{
  const PetscReal of_surfaces = 1e-2, poor = solver->problem->objective->poor_energy;
  const PetscBool more_wanted = (PetscBool)(solver->settings.balance > 0. || solver->problem->landmarks.num_total > 0);

  return solver->mesh->cell_size == 3 && !more_wanted ? PetscMin(of_surfaces, poor) : poor;
}

/* Is the map so far from equal areas that it is of no use as such? */
static PetscBool IsPoor(EqmSolver solver)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;
  const PetscReal poor = EqmJudgePoorEnergy(solver);

  return (PetscBool)(poor > 0. && !(totals->energy <= poor * totals->total));
}

/* A method that has converged, but to a map far from equal areas, has not converged. */
static void RejectPoorMap(EqmSolver solver)
{
  if (IsPoor(solver)) solver->status = EQM_STATUS_NOT_CONVERGED;
}

/* Energy target, ratios, gradient: is one of them reached? */
static PetscErrorCode MeetsTolerance(EqmSolver solver, PetscBool *meets)
{
  const EqmSolverSettings *const set = &solver->settings;
  const EqmIterate iterate = solver->iterate;
  const EqmImageTotals *const totals = &iterate->totals;
  PetscBool reached;

  PetscFunctionBegin;
  PetscCall(EqmSolverLandmarksReached(solver, &reached));
  *meets = PETSC_TRUE;
  if (reached && set->energy_target > 0. && totals->energy <= set->energy_target) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "the energy has reached its target %.6g",
                            (double)set->energy_target));
  } else if (reached && set->ratio_tol > 0. && totals->energy <= PetscSqr(set->ratio_tol) * totals->total) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "the ratios are within %.6g of one, root mean square", (double)set->ratio_tol));
  } else if (iterate->gradient_norm >= 0. && iterate->gradient_norm <= set->gradient_tol) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "the gradient's norm is below %.6g",
                            (double)set->gradient_tol));
  } else {
    *meets = PETSC_FALSE;
  }
  PetscFunctionReturn(0);
}

/* Is a limit on iterations, factorisations or time exceeded? By rank 0's clock, so that all ranks agree. */
static PetscErrorCode ExceedsLimit(EqmSolver solver, PetscBool *stop)
{
  const EqmSolverSettings *const set = &solver->settings;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(solver->mesh->ledger, &work));
  *stop = PETSC_TRUE;
  solver->limited = PETSC_TRUE;
  if (solver->iterate->number >= set->max_it) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "stopped after -max_it %" PetscInt_FMT " iterations", set->max_it));
  } else if (set->max_factorizations > 0 && work->coupled_factorizations >= set->max_factorizations) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "stopped after -max_factorizations %" PetscInt_FMT, set->max_factorizations));
  } else {
    PetscCall(EqmCheckpointStopRequested(solver, stop));
    solver->limited = *stop;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode DescribeCollapse(EqmSolver solver)
{
  PetscFunctionBegin;
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscStrncpy(
      solver->message,
      "the boundary folds on the way to the least energy: the map is the one that a barrier holds; a finer mesh, "
      "or -repair where cells have all vertices on the boundary, may have a minimum",
      sizeof(solver->message)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmJudgeIteration(EqmSolver solver, PetscBool *stop)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverHasCollapsed(solver, stop));
  solver->collapsed = *stop;
  if (*stop) PetscCall(DescribeCollapse(solver));
  if (*stop) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_CONVERGED;
  PetscCall(MeetsTolerance(solver, stop));
  if (*stop) PetscFunctionReturn(0);
  *stop = Stagnates(solver);
  if (*stop) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "the objective fell by less than %.6g %% per iteration over the last %" PetscInt_FMT
                            " iterations",
                            100. * (double)solver->settings.energy_rtol, solver->settings.stagnation));
    RejectPoorMap(solver);
    PetscFunctionReturn(0);
  }
  *stop = StandsStill(solver);
  if (*stop) {
    PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message),
                            "the objective fell by no more than %.6g in the last iteration",
                            (double)solver->settings.energy_atol));
    RejectPoorMap(solver);
    PetscFunctionReturn(0);
  }
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(ExceedsLimit(solver, stop));
  PetscFunctionReturn(0);
}

/* Are the ratios one to half of the digits and more? No step can do better than that in a double's arithmetic. */
static PetscBool IsExact(EqmSolver solver)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;

  return (PetscBool)(solver->problem->objective->poor_energy > 0. && totals->folds == 0 &&
                     totals->energy <= PetscSqr(1e-11) * totals->total);
}

/* Has the method come to rest where the slope is gone? Then the minimum is reached, whatever it is. */
static PetscBool IsStationary(EqmSolver solver)
{
  const PetscReal flat = 1e-6, level = 1e-8; /* of the steepest slope; of the objective, in the last step */
  const PetscInt last = solver->num_history - 1;
  const PetscReal slope = last < 2 ? -1. : solver->history[last].gradient_norm;
  PetscReal steepest = 0.;

  for (PetscInt k = 0; k <= last; k++) steepest = PetscMax(steepest, solver->history[k].gradient_norm);
  if (slope < 0. || slope > flat * steepest) return PETSC_FALSE;
  return (PetscBool)(solver->objectives[last - 1] - solver->objectives[last] <=
                     level * PetscAbsReal(solver->objectives[last]));
}

PetscErrorCode EqmJudgeEnd(EqmSolver solver, EqmStep outcome)
{
  const PetscBool converged = (PetscBool)(outcome == EQM_STEP_CONVERGED || IsExact(solver) || IsStationary(solver));
  const char *const usual =
      converged ? "the next step would change the objective by rounding only"
                : "no step decreases the objective any more: the limit of this method and this arithmetic";

  PetscFunctionBegin;
  solver->checkpoints.finished = PETSC_TRUE;
  solver->status = converged ? EQM_STATUS_CONVERGED : EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscStrncpy(solver->message, solver->method->message[0] ? solver->method->message : usual,
                         sizeof(solver->message)));
  if (converged) RejectPoorMap(solver);
  PetscFunctionReturn(0);
}

/* Did the objective fall by more than a ten-thousandth over the last iterations? On strips ten thousands of times as
   long as wide steps are short, as the circle bends within them by more than a cell: E hardly falls for a hundred. */
static PetscBool StillFalls(EqmSolver solver)
{
  const PetscInt last = solver->num_history - 1, before = last - solver->settings.stagnation;
  const PetscReal least = 1e-4;

  return (PetscBool)(before >= 0 && solver->objectives[before] - solver->objectives[last] >
                                        least * PetscAbsReal(solver->objectives[before]));
}

PetscErrorCode EqmJudgePoor(EqmSolver solver)
{
  const char *const measures = solver->mesh->cell_size == 3 ? "areas" : "volumes";

  PetscFunctionBegin;
  solver->poor = (PetscBool)(solver->status == EQM_STATUS_NOT_CONVERGED && IsPoor(solver));
  if (!solver->poor) PetscFunctionReturn(0);
  PetscCall(PetscSNPrintf(solver->message + strlen(solver->message), sizeof(solver->message) - strlen(solver->message),
                          "; the map is poor, far from equal %s: ratios are off by %.2g, root mean square (the target "
                          "may not suit the mesh: corners, slivers, thin limbs?)%s",
                          measures, (double)PetscSqrtReal(EqmIterateMeanEnergy(solver->iterate)),
                          StillFalls(solver) ? "; the objective still fell: -energy_rtol 0 -max_it 500 goes on" : ""));
  PetscFunctionReturn(0);
}

/* What may do without folds: better cells where this is the default, else the default, or a start that is for it. */
static const char *WhatMayHelp(EqmSolver solver)
{
  const EqmMethodDefaults *const first = &solver->formulation->methods[0];
  const char *const limbs = solver->formulation->where_limbs_fold;

  if (!strcmp(solver->defaults.name, first->name) && !strcmp(solver->start->name, first->start))
    return " cells of a better shape, or finer ones, may help";
  if (limbs && strcmp(solver->start->name, EqmStartSphereResolved.name)) return limbs;
  return " try the default method and its start";
}

PetscErrorCode EqmJudgeFolds(EqmSolver solver)
{
  const PetscBool solid = (PetscBool)(solver->mesh->cell_size == 4);
  PetscInt64 on_boundary = 0;

  PetscFunctionBegin;
  if (solid) PetscCall(EqmImageBoundaryFolds(solver->problem->domain, &solver->iterate->place, &on_boundary));
  if (solver->iterate->totals.folds == 0 && on_boundary == 0) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_FOLDS;
  PetscCall(PetscSNPrintf(solver->message, sizeof(solver->message), "%" PetscInt64_FMT " %s of the map are folded over",
                          solver->iterate->totals.folds, solid ? "tetrahedra" : "triangles"));
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
  PetscCall(PetscStrlcat(solver->message, WhatMayHelp(solver), sizeof(solver->message)));
  PetscFunctionReturn(0);
}
