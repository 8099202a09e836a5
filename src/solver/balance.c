/* -balance_energy: the least shear with E of no more than that. The map that is balanced with one weight begins the
   minimisation with a smaller one, until E is low enough; each has, if the run has checkpoints, one of its own. */
#include "solver/attempt.h"
#include <string.h>

/* Weights of the angle energy: the first where -balance does not say, large so that the map is a smooth one to begin
   with; below the last one it no longer moves a map. */
static const PetscReal first_weight = .1, last_weight = 1e-8;

PetscErrorCode EqmBalanceBegin(EqmSolver solver)
{
  EqmSolverSettings *const set = &solver->settings;

  PetscFunctionBegin;
  if (set->balance_energy > 0. && set->balance <= 0.) set->balance = first_weight;
  PetscFunctionReturn(0);
}

static EqmTerm FindAngleTerm(EqmProblem problem)
{
  EqmTerm term = problem->terms;

  while (term && strcmp(term->name, "angle")) term = term->next;
  return term;
}

/* The weight at which a power law through the last two ends has E a little below what is wanted, within bounds, as far
   from the minimum E obeys none. `then`: weight and E before; E of zero: there was none. */
static PetscReal NextWeight(PetscReal weight, PetscReal energy, PetscReal wanted, const PetscReal then[2])
{
  const PetscReal aim = .9, least_factor = .1, most_factor = .7;
  PetscReal power = 1.;

  if (then[1] > energy) power = PetscLogReal(then[1] / energy) / PetscLogReal(then[0] / weight);
  const PetscReal factor = PetscPowReal(aim * wanted / energy, 1. / PetscMax(power, .25));
  return weight * PetscMin(most_factor, PetscMax(least_factor, factor));
}

/* On from the present map with this weight. Whatever it leads to is the run's map. */
static PetscErrorCode GoOn(EqmSolver solver, PetscReal weight, EqmAttempts *attempts)
{
  const PetscBool own_limit = (PetscBool)(solver->settings.max_it != solver->defaults.max_it);
  EqmAttempt before;

  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem, "energy %.3g: on with -balance %.3g\n",
                             (double)solver->iterate->totals.energy, (double)weight));
  solver->settings.balance = attempts->first.balance = weight;
  FindAngleTerm(solver->problem)->weight = weight;
  if (!own_limit) solver->settings.max_it = solver->iterate->number + solver->defaults.max_it;
  PetscCall(EqmAttemptContinue(solver, attempts, &before));
  PetscCall(EqmSolverRun(solver));
  PetscCall(EqmAttemptDestroy(&before));
  solver->settings.max_it = attempts->first.max_it;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBalanceLower(EqmSolver solver, EqmAttempts *attempts)
{
  const EqmSolverSettings *const set = &solver->settings;
  const PetscReal wanted = set->balance_energy;
  PetscReal then[2] = {0., 0.};

  PetscFunctionBegin;
  if (!(wanted > 0.)) PetscFunctionReturn(0);
  while (solver->iterate->totals.energy > wanted && solver->iterate->totals.folds == 0 && set->balance > last_weight &&
         solver->status != EQM_STATUS_STOPPED && !solver->limited) {
    const PetscReal now[2] = {set->balance, solver->iterate->totals.energy};
    PetscCall(GoOn(solver, NextWeight(now[0], now[1], wanted, then), attempts));
    then[0] = now[0];
    then[1] = now[1];
  }
  if (solver->status == EQM_STATUS_STOPPED || solver->iterate->totals.folds > 0) PetscFunctionReturn(0);
  PetscCall(PetscSNPrintf(solver->message + strlen(solver->message), sizeof(solver->message) - strlen(solver->message),
                          "; with -balance %.3g", (double)set->balance));
  if (solver->iterate->totals.energy <= wanted || solver->limited) PetscFunctionReturn(0);
  solver->status = EQM_STATUS_NOT_CONVERGED;
  PetscCall(PetscStrlcat(solver->message, " the energy is above -balance_energy, and no weight lowers it",
                         sizeof(solver->message)));
  PetscFunctionReturn(0);
}
