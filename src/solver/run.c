/* One run: the loop that all methods share, a second one where a solid's map collapses, unfolding. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "solver/judge.h"
#include "solver/mend.h"
#include <string.h>

/* The method is ready for its first step, or for the next one of a run that was interrupted. */
static PetscErrorCode SetUpMethod(EqmSolver solver)
{
  PetscFunctionBegin;
  solver->iterate->figures = EQM_STEP_UNKNOWN;
  solver->method->goes_on = (PetscBool)(solver->settings.energy_target > 0. || solver->settings.energy_rtol > 0.);
  solver->method->energy_target = solver->settings.energy_target;
  PetscCall(EqmMethodSetUp(solver->method, solver->problem, solver->iterate));
  PetscCall(EqmSolverCallMonitor(solver, EQM_MONITOR_BEGIN, solver->problem->linear_solver));
  if (solver->checkpoints.open)
    PetscCall(EqmCheckpointLoadMethod(solver));
  else
    PetscCall(EqmHistoryAddRow(solver));
  PetscFunctionReturn(0);
}

/* Without degrees of freedom the first map is the only one. */
static PetscErrorCode HasOneMap(EqmSolver solver, PetscBool *has_one)
{
  PetscInt num_dofs;

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(&solver->problem->domain->num_dofs, &num_dofs, 1, MPIU_INT, MPI_SUM, solver->comm));
  *has_one = (PetscBool)(num_dofs == 0);
  if (!*has_one) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_CONVERGED;
  PetscCall(PetscStrncpy(solver->message, "every vertex is held: there is one map", sizeof(solver->message)));
  solver->iterate->objective = solver->iterate->totals.energy;
  solver->iterate->gradient_norm = -1.;
  solver->iterate->figures = EQM_STEP_UNKNOWN;
  PetscCall(EqmSolverCallMonitor(solver, EQM_MONITOR_BEGIN, ""));
  PetscCall(EqmHistoryAddRow(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode Iterate(EqmSolver solver)
{
  EqmIterate const iterate = solver->iterate;
  PetscBool stop = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(HasOneMap(solver, &stop));
  if (stop) PetscFunctionReturn(0);
  PetscCall(SetUpMethod(solver));
  if (!solver->checkpoints.finished) PetscCall(EqmJudgeIteration(solver, &stop));
  while (!stop && !solver->checkpoints.finished) {
    EqmStep outcome;
    PetscCall(EqmCheckpointIfDue(solver));
    iterate->figures = EQM_STEP_UNKNOWN;
    iterate->unfolded_from = 0;
    PetscCall(EqmMethodStep(solver->method, iterate, &outcome));
    if (outcome != EQM_STEP_TAKEN) {
      PetscCall(EqmJudgeEnd(solver, outcome));
      break;
    }
    iterate->number++;
    PetscCall(EqmHistoryAddRow(solver));
    PetscCall(EqmJudgeIteration(solver, &stop));
  }
  PetscCall(EqmCheckpointEnd(solver));
  PetscCall(EqmMethodReset(solver->method));
  PetscFunctionReturn(0);
}

/* From a map of the solid to the ball the iterations may find a minimum that is one; else that map is the result. */
static PetscErrorCode IterateAgain(EqmSolver solver)
{
  const PetscBool tried = (PetscBool)(solver->begun_again > 0); /* before a restart */
  EqmPlace unfolded;

  PetscFunctionBegin;
  PetscCall(EqmSolverBeginAgain(solver));
  if (tried) PetscFunctionReturn(0);
  PetscCall(EqmPlaceCreate(solver->problem->domain, &unfolded));
  PetscCall(EqmPlaceCopy(solver->problem->domain, &solver->iterate->place, &unfolded));
  PetscCall(Iterate(solver));
  if (solver->collapsed) {
    PetscCall(EqmPlaceCopy(solver->problem->domain, &unfolded, &solver->iterate->place));
    PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  }
  PetscCall(EqmPlaceDestroy(&unfolded));
  PetscFunctionReturn(0);
}

/* The formulation's final normalisation, then unfolding where there is a method for it. */
static PetscErrorCode End(EqmSolver solver)
{
  PetscBool unfolded;

  PetscFunctionBegin;
  if (solver->formulation->finish) PetscCall(solver->formulation->finish(solver));
  PetscCall(EqmSolverMend(solver, "at the end", &unfolded));
  if (unfolded) PetscCall(EqmHistoryAddRow(solver));
  if (solver->status != EQM_STATUS_STOPPED) PetscCall(EqmJudgeFolds(solver));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverRun(EqmSolver solver)
{
  PetscFunctionBegin;
  if (solver->iterate->unfolded_from > 0 && !solver->checkpoints.open)
    PetscCall(EqmSolverNotifyUnfolded(solver, "at the start"));
  PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  PetscCall(Iterate(solver));
  if (solver->collapsed) PetscCall(IterateAgain(solver));
  PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_MINIMISE));
  if (solver->status != EQM_STATUS_STOPPED) PetscCall(End(solver));
  PetscFunctionReturn(0);
}
