/* What a run does before it tells the user that its map is not good. lm minimises logarithms of ratios, which bring
   collapsed cells back and are lenient with those that are too large; where ratios are off at the end by more than one
   in a hundred it goes on with the mixed residual, which is close to E on that side. Where that leaves folds, or a
   map that is far off, other starts are tried. Each attempt has, if the run has checkpoints, one of its own: FILE.2,
   FILE.3, ... The best map is the run's. */
#include "solver/judge.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include "problem/term.h"
#include "solver/inner.h"
#include <string.h>

/* Above this energy, per measure of the image, the mixed residual does better: ratios off by one in a hundred. */
static const PetscReal fair_energy = 1e-4;

enum { MOST_STARTS = 8 };

/* What one attempt has found. */
typedef struct {
  EqmIterate iterate;
  EqmHistoryRow *history;
  PetscReal *objectives;
  PetscInt num_history, max_history;
  EqmStatus status;
  char message[EQM_MESSAGE_MAX];
  const EqmStartType *start;
} Attempt;

#define SWAP(type, a, b)                                                                                               \
  do {                                                                                                                 \
    type kept = (a);                                                                                                   \
    (a) = (b);                                                                                                         \
    (b) = kept;                                                                                                        \
  } while (0)

static PetscErrorCode Exchange(EqmSolver solver, Attempt *attempt)
{
  char message[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  SWAP(EqmIterate, solver->iterate, attempt->iterate);
  SWAP(EqmHistoryRow *, solver->history, attempt->history);
  SWAP(PetscReal *, solver->objectives, attempt->objectives);
  SWAP(PetscInt, solver->num_history, attempt->num_history);
  SWAP(PetscInt, solver->max_history, attempt->max_history);
  SWAP(EqmStatus, solver->status, attempt->status);
  SWAP(const EqmStartType *, solver->start, attempt->start);
  PetscCall(PetscStrncpy(message, solver->message, sizeof(message)));
  PetscCall(PetscStrncpy(solver->message, attempt->message, sizeof(solver->message)));
  PetscCall(PetscStrncpy(attempt->message, message, sizeof(attempt->message)));
  solver->rows_shown = 0;
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(Attempt *attempt)
{
  PetscFunctionBegin;
  PetscCall(EqmIterateDestroy(&attempt->iterate));
  PetscCall(PetscFree(attempt->history));
  PetscCall(PetscFree(attempt->objectives));
  PetscFunctionReturn(0);
}

/* Is the map without folds, but further from equal ratios than `level`? What a user has limited is left as it is, and
   with terms equal ratios are not all that is wanted, so that only a poor map is off. */
static PetscBool IsOff(EqmSolver solver, PetscReal level)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;
  const PetscReal poor = EqmJudgePoorEnergy(solver);

  if (solver->status == EQM_STATUS_STOPPED || solver->limited || totals->folds > 0) return PETSC_FALSE;
  return (PetscBool)(poor > 0. && totals->energy > (solver->problem->terms ? poor : level) * totals->total);
}

/* Is there a reason to try a start for maps with so much energy? */
static PetscBool IsDisappointing(EqmSolver solver, PetscReal far_energy)
{
  if (solver->status == EQM_STATUS_STOPPED || solver->limited) return PETSC_FALSE;
  return (PetscBool)(solver->iterate->totals.folds > 0 || IsOff(solver, far_energy));
}

/* E and the terms; without them E per area of the image, which is how far ratios are off: a map of few boundary
   vertices has less E where its image is small. */
static PetscErrorCode Evaluate(EqmProblem problem, EqmIterate iterate, PetscReal *value)
{
  PetscReal *image;

  PetscFunctionBegin;
  *value = problem->terms ? iterate->totals.energy : iterate->totals.energy / iterate->totals.total;
  if (!problem->terms) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &image));
  PetscCall(EqmProblemEvaluate(problem, iterate, &iterate->place, image, value, NULL));
  PetscCall(PetscFree(image));
  PetscFunctionReturn(0);
}

/* Fewer folds, or as many and a lower value. */
static PetscErrorCode IsBetter(EqmProblem problem, EqmIterate a, EqmIterate b, PetscBool *better)
{
  PetscReal of_a, of_b;

  PetscFunctionBegin;
  PetscCall(Evaluate(problem, a, &of_a));
  PetscCall(Evaluate(problem, b, &of_b));
  *better = (PetscBool)(a->totals.folds == b->totals.folds ? of_a < of_b : a->totals.folds < b->totals.folds);
  PetscFunctionReturn(0);
}

/* The attempt's end, or, unless the run has been stopped, what was before if that is the better one. */
static PetscErrorCode TakeBetter(EqmSolver solver, PetscBool ended, Attempt *before)
{
  PetscBool better = ended;

  PetscFunctionBegin;
  if (ended && solver->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  if (ended) PetscCall(IsBetter(solver->problem, solver->iterate, before->iterate, &better));
  if (!better) PetscCall(Exchange(solver, before));
  PetscFunctionReturn(0);
}

static PetscErrorCode Tell(EqmSolver solver, const char *next)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;

  PetscFunctionBegin;
  PetscCall(EqmProblemNotify(solver->problem,
                             "from -start %s to energy %.3g and %" PetscInt64_FMT " folds in %" PetscInt_FMT
                             " iterations: once more from -start %s\n",
                             solver->start->name, (double)totals->energy, totals->folds, solver->iterate->number,
                             next));
  PetscFunctionReturn(0);
}

/* The names of checkpoints, for the k-th attempt. `first` is what they were for the first. */
static PetscErrorCode SetStage(EqmSolver solver, const EqmSolverSettings *first, size_t suffix, PetscInt k)
{
  EqmSolverSettings *const set = &solver->settings;
  EqmCheckpoints *const known = &solver->checkpoints;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(set->checkpoint, first->checkpoint, sizeof(set->checkpoint)));
  PetscCall(PetscStrncpy(set->restart, first->restart, sizeof(set->restart)));
  known->suffix = suffix;
  known->written = -1;
  known->resumed = 0;
  known->finished = PETSC_FALSE;
  if (k > 1) PetscCall(EqmSolverSetStage(solver, k));
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

/* ---- the mixed residual */

/* The map so far, its history and what the checkpoint of this attempt has in their place. */
static PetscErrorCode TakeOver(EqmSolver solver, const Attempt *from)
{
  EqmIterate const iterate = solver->iterate;

  PetscFunctionBegin;
  solver->limited = PETSC_FALSE;
  if (solver->settings.restart[0]) {
    PetscCall(EqmCheckpointLoadMap(solver));
  } else {
    PetscCall(EqmPlaceCopy(solver->problem->domain, &from->iterate->place, &iterate->place));
    iterate->number = from->iterate->number + 1;
    PetscCall(EqmHistoryReserve(solver, from->num_history));
    PetscCall(PetscArraycpy(solver->history, from->history, from->num_history));
    PetscCall(PetscArraycpy(solver->objectives, from->objectives, from->num_history));
    solver->begun_again = solver->num_history = from->num_history;
  }
  PetscCall(EqmIterateUpdate(solver->problem, iterate));
  PetscFunctionReturn(0);
}

/* Go on from the present map, as the next attempt, if that is for it. */
static PetscErrorCode GoOn(EqmSolver solver, const EqmSolverSettings *first, size_t suffix, PetscInt *attempt)
{
  Attempt before = {.status = EQM_STATUS_NOT_CONVERGED, .start = solver->start};
  PetscBool can = PETSC_FALSE;

  PetscFunctionBegin;
  if (!strcmp(solver->defaults.method, "lm")) PetscCall(EqmLmIsByLogarithms(solver->method, &can));
  if (!can || !IsOff(solver, fair_energy) || solver->iterate->number >= solver->settings.max_it) PetscFunctionReturn(0);
  PetscCall(SetStage(solver, first, suffix, ++*attempt));
  PetscCall(EqmProblemNotify(solver->problem, "energy %.3g: on with the mixed residual\n",
                             (double)solver->iterate->totals.energy));
  PetscCall(EqmIterateCreate(solver->problem, &before.iterate));
  PetscCall(Exchange(solver, &before));
  PetscCall(TakeOver(solver, &before));
  PetscCall(EqmLmSetResidual(solver->method, &EqmResidualMixed));
  PetscCall(EqmSolverRun(solver));
  PetscCall(EqmLmSetResidual(solver->method, NULL));
  PetscCall(TakeBetter(solver, PETSC_TRUE, &before));
  PetscCall(Destroy(&before));
  PetscFunctionReturn(0);
}

/* ---- other starts */

/* From another start, as the next attempt. `count`: starts tried. */
static PetscErrorCode TryStart(EqmSolver solver, const EqmStartType *start, const EqmSolverSettings *first,
                               size_t suffix, PetscInt *attempt, PetscInt count, PetscReal *tried)
{
  Attempt other = {.status = EQM_STATUS_NOT_CONVERGED, .start = start};
  PetscBool begun;

  PetscFunctionBegin;
  PetscCall(SetStage(solver, first, suffix, ++*attempt));
  PetscCall(Tell(solver, start->name));
  PetscCall(EqmIterateCreate(solver->problem, &other.iterate));
  PetscCall(Exchange(solver, &other));
  PetscCall(Begin(solver, count, tried, &begun));
  if (begun) PetscCall(EqmSolverRun(solver));
  if (begun) PetscCall(GoOn(solver, first, suffix, attempt));
  PetscCall(TakeBetter(solver, begun, &other));
  PetscCall(Destroy(&other));
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

static PetscErrorCode TryStarts(EqmSolver solver, const EqmSolverSettings *first, size_t suffix, PetscInt *attempt)
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
    PetscCall(TryStart(solver, start, first, suffix, attempt, count++, tried));
  }
  if (count > 1 && solver->status == EQM_STATUS_NOT_CONVERGED && !solver->limited)
    PetscCall(PetscStrlcat(solver->message, "; other starts did no better", sizeof(solver->message)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverTryAgain(EqmSolver solver)
{
  const EqmSolverSettings first = solver->settings;
  const size_t suffix = solver->checkpoints.suffix;
  PetscInt attempt = 1;

  PetscFunctionBegin;
  PetscCall(GoOn(solver, &first, suffix, &attempt));
  if (HasOtherStarts(solver)) PetscCall(TryStarts(solver, &first, suffix, &attempt));
  if (attempt > 1) PetscCall(SetStage(solver, &first, suffix, 1));
  PetscFunctionReturn(0);
}
