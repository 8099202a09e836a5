/* What a run does before it tells the user that its map is not good. lm minimises logarithms of ratios, which bring
   collapsed cells back and are lenient with those that are too large; where ratios are off at the end by more than one
   in a hundred it goes on with the mixed residual, which is close to E on that side. Where that leaves folds, or a
   map that is far off, other starts are tried, and on the sphere Newton steps with a barrier. Each attempt has, if the
   run has checkpoints, one of its own: FILE.2, FILE.3, ... The best map is the run's. */
#include "solver/attempt.h"
#include "solver/judge.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include <string.h>

/* Above this energy, per measure of the image, the mixed residual does better: ratios off by one in a hundred. */
static const PetscReal fair_energy = 1e-4;

enum { MOST_STARTS = 8 };

/* Is the map without folds, but further from equal ratios than `level`? What a user has limited is left as it is, or has
   wanted no better; with terms equal ratios are not all that is wanted, so that only a poor map is off. */
static PetscBool IsOff(EqmSolver solver, PetscReal level)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;
  const PetscReal poor = EqmJudgePoorEnergy(solver);

  if (totals->energy <= solver->settings.energy_target) return PETSC_FALSE;
  if (solver->status == EQM_STATUS_STOPPED || solver->limited || totals->folds > 0) return PETSC_FALSE;
  return (PetscBool)(poor > 0. && totals->energy > (solver->problem->terms ? poor : level) * totals->total);
}

/* Is there a reason to try a start for maps with so much energy? */
static PetscBool IsDisappointing(EqmSolver solver, PetscReal far_energy)
{
  if (solver->status == EQM_STATUS_STOPPED || solver->limited) return PETSC_FALSE;
  return (PetscBool)(solver->iterate->totals.folds > 0 || IsOff(solver, far_energy));
}

static PetscErrorCode Tell(EqmSolver solver, const char *next, const char *how)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;

  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem,
                             "from -start %s to energy %.3g and %" PetscInt64_FMT " folds in %" PetscInt_FMT
                             " iterations: once more from -start %s%s\n",
                             solver->start->name, (double)totals->energy, totals->folds, solver->iterate->number, next,
                             how));
  PetscFunctionReturn(0);
}

/* The first map. A start that this mesh is not for is no failure of the run, nor is one that ends with folds, which the
   method could not take, or with a map that has been tried: `tried` has the first energies of the attempts before, of
   number `count`. */
static PetscErrorCode Begin(EqmSolver solver, PetscInt count, PetscReal *tried, PetscBool *begun)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error;

  PetscFunctionBegin;
  solver->limited = PETSC_FALSE;
  solver->begun_again = 0;
  solver->collapsed = PETSC_FALSE;
  solver->settings.start.steps = -1;
  PetscCall(EqmPhaseBegin(solver->mesh->ledger, EQM_PHASE_START));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = solver->settings.restart[0] ? EqmCheckpointLoadMap(solver) : EqmSolverMakeFirstMap(solver);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmPhaseEnd(solver->mesh->ledger, EQM_PHASE_START));
  PetscCheck(!error || error == EQM_ERR_MESH, solver->comm, error, "%s", message);
  if (!error) PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  *begun = (PetscBool)(!error && solver->iterate->totals.folds == 0);
  tried[count] = error ? -1. : solver->iterate->totals.energy;
  for (PetscInt k = 0; k < count; k++) *begun = (PetscBool)(*begun && tried[k] != tried[count]);
  PetscFunctionReturn(0);
}

/* ---- from the same map */

/* Go on with the mixed residual, if that is for it. */
static PetscErrorCode GoOnMixed(EqmSolver solver, EqmAttempts *attempts)
{
  PetscBool can = PETSC_FALSE;
  EqmAttempt before;

  PetscFunctionBegin;
  if (!strcmp(solver->defaults.method, "lm")) PetscCall(EqmLmIsByLogarithms(solver->method, &can));
  if (!can || !IsOff(solver, fair_energy) || solver->iterate->number >= solver->settings.max_it) PetscFunctionReturn(0);
  PetscCall(EqmProblemNotify(solver->problem, "energy %.3g: on with the mixed residual\n",
                             (double)solver->iterate->totals.energy));
  PetscCall(EqmAttemptContinue(solver, attempts, &before));
  PetscCall(EqmLmSetResidual(solver->method, &EqmResidualMixed));
  PetscCall(EqmSolverRun(solver));
  PetscCall(EqmLmSetResidual(solver->method, NULL));
  PetscCall(EqmAttemptTakeBetter(solver, PETSC_TRUE, &before));
  PetscCall(EqmAttemptDestroy(&before));
  PetscFunctionReturn(0);
}

/* ---- other starts */

/* From another start, as the next attempt. `count`: starts tried. */
static PetscErrorCode TryStart(EqmSolver solver, const EqmStartType *start, EqmAttempts *attempts, PetscInt count,
                               PetscReal *tried)
{
  EqmAttempt other = {.status = EQM_STATUS_NOT_CONVERGED, .start = start};
  PetscBool begun;

  PetscFunctionBegin;
  PetscCall(EqmAttemptsNext(solver, attempts));
  PetscCall(Tell(solver, start->name, strcmp(solver->defaults.method, "newton") ? "" : " by Newton steps"));
  PetscCall(EqmIterateCreate(solver->problem, &other.iterate));
  PetscCall(EqmAttemptExchange(solver, &other));
  PetscCall(Begin(solver, count, tried, &begun));
  if (begun) PetscCall(EqmSolverRun(solver));
  if (begun) PetscCall(GoOnMixed(solver, attempts));
  PetscCall(EqmAttemptTakeBetter(solver, begun, &other));
  PetscCall(EqmAttemptDestroy(&other));
  PetscFunctionReturn(0);
}

/* Other starts are for runs from the default's. */
static PetscBool HasOtherStarts(EqmSolver solver)
{
  const EqmFormulation *const formulation = solver->formulation;

  return (PetscBool)(formulation->other_starts && !solver->first_map &&
                     !strcmp(solver->start->name, formulation->methods[0].start));
}

PetscBool EqmSolverIsBlocked(EqmSolver solver)
{
  return (PetscBool)(HasOtherStarts(solver) && solver->iterate->totals.folds > 0 &&
                     !strcmp(solver->defaults.method, "lm"));
}

static PetscErrorCode TryStarts(EqmSolver solver, EqmAttempts *attempts)
{
  const EqmFormulation *const formulation = solver->formulation;
  PetscInt count = 1;
  PetscReal tried[MOST_STARTS];

  PetscFunctionBegin;
  tried[0] = solver->num_history > 0 ? solver->history[0].energy : -1.;
  for (const EqmOtherStart *other = formulation->other_starts; other->name && count < MOST_STARTS; other++) {
    const EqmStartType *start;

    if (!IsDisappointing(solver, other->far_energy)) continue;
    PetscCall(EqmStartFind(solver->comm, formulation->starts, formulation->domain, other->name, &start));
    PetscCall(TryStart(solver, start, attempts, count++, tried));
  }
  if (count > 1 && solver->status == EQM_STATUS_NOT_CONVERGED && !solver->limited)
    PetscCall(PetscStrlcat(solver->message, "; other starts did no better", sizeof(solver->message)));
  PetscFunctionReturn(0);
}

/* ---- Newton steps with a barrier */

/* Newton steps need the time of a factorisation each, hundreds of times. */
static PetscBool CanGoOnByNewton(EqmSolver solver)
{
  const PetscInt64 most_vertices = 30000;
  const PetscBool inner = solver->checkpoints.ignores_requests; /* the start of a solid need not be so good */

  if (strcmp(solver->defaults.method, "lm") || !solver->problem->domain->curved_image || inner) return PETSC_FALSE;
  return (PetscBool)(solver->mesh->num_vertices <= most_vertices &&
                     solver->settings.max_it == solver->defaults.max_it); /* a limit of the user's is for lm */
}

/* What newton takes the place of. */
typedef struct {
  EqmMethod method;
  EqmMethodDefaults defaults;
} Host;

static PetscErrorCode TakeNewton(EqmSolver solver, PetscReal barrier, Host *lm)
{
  enum { MOST_STEPS = 2000 };
  const PetscReal energy_rtol = 1e-3;

  PetscFunctionBegin;
  *lm = (Host){solver->method, solver->defaults};
  PetscCall(EqmFormulationFindMethod(solver->comm, solver->formulation, "newton", &solver->defaults));
  PetscCall(EqmSolverCreateMethod(solver, &solver->defaults, NULL, &solver->method));
  PetscCall(EqmNewtonSetBarrier(solver->method, barrier));
  solver->settings.max_it = solver->iterate->number + MOST_STEPS;
  solver->settings.energy_rtol = energy_rtol;
  PetscFunctionReturn(0);
}

static PetscErrorCode TakeBackLm(EqmSolver solver, const EqmSolverSettings *first, const Host *lm)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodDestroy(&solver->method));
  solver->method = lm->method;
  solver->defaults = lm->defaults;
  solver->settings.max_it = first->max_it;
  solver->settings.energy_rtol = first->energy_rtol;
  PetscFunctionReturn(0);
}

/* From the present map. */
static PetscErrorCode GoOnByNewton(EqmSolver solver, PetscReal barrier, EqmAttempts *attempts)
{
  EqmAttempt before;
  Host lm;

  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem, "energy %.3g: on with Newton steps and a barrier of weight %g\n",
                             (double)solver->iterate->totals.energy, (double)barrier));
  PetscCall(TakeNewton(solver, barrier, &lm));
  PetscCall(EqmAttemptContinue(solver, attempts, &before));
  PetscCall(EqmSolverRun(solver));
  PetscCall(TakeBackLm(solver, &attempts->first, &lm));
  PetscCall(EqmAttemptTakeBetter(solver, PETSC_TRUE, &before));
  PetscCall(EqmAttemptDestroy(&before));
  PetscFunctionReturn(0);
}

/* With a large weight, so that triangles first become short, from the best map; of meshes on which that is a matter of
   seconds, from the first map for limbs as well, whose triangles lm has not jammed yet. With a small weight where that
   leads to no better map. */
static PetscErrorCode TryNewton(EqmSolver solver, PetscBool other_starts, EqmAttempts *attempts)
{
  const PetscBool is_small = (PetscBool)(solver->mesh->num_vertices <= 10000);
  const PetscReal short_first = 30., as_is = .01;
  const PetscReal far_energy = is_small ? fair_energy : 1e-3;
  const PetscReal before = EqmIterateMeanEnergy(solver->iterate);
  const EqmStartType *const limbs = &EqmStartSphereSolidAngle;
  PetscReal tried;
  Host lm;

  PetscFunctionBegin;
  if (!CanGoOnByNewton(solver)) PetscFunctionReturn(0);
  if (IsOff(solver, far_energy)) PetscCall(GoOnByNewton(solver, short_first, attempts));
  if (other_starts && is_small && IsOff(solver, far_energy)) {
    PetscCall(TakeNewton(solver, short_first, &lm));
    PetscCall(TryStart(solver, limbs, attempts, 0, &tried));
    PetscCall(TakeBackLm(solver, &attempts->first, &lm));
  }
  if (IsOff(solver, fair_energy) && !(EqmIterateMeanEnergy(solver->iterate) < before))
    PetscCall(GoOnByNewton(solver, as_is, attempts));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverTryAgain(EqmSolver solver)
{
  EqmAttempts attempts = {.first = solver->settings, .suffix = solver->checkpoints.suffix, .count = 1};
  PetscBool other_starts;

  PetscFunctionBegin;
  PetscCall(EqmBalanceLower(solver, &attempts));
  PetscCall(GoOnMixed(solver, &attempts));
  other_starts = HasOtherStarts(solver);
  if (other_starts) PetscCall(TryStarts(solver, &attempts));
  PetscCall(TryNewton(solver, other_starts, &attempts));
  PetscCall(EqmAttemptsEnd(solver, &attempts));
  PetscFunctionReturn(0);
}
