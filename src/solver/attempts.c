/* Other starts, where the default's has led nowhere: a map with folds, one that is far from what the objective wants,
   or a method that stands still before it. Each attempt begins anew with its own history and, if the run has
   checkpoints, its own: FILE.2, FILE.3, ... The best map is the run's. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include "solver/inner.h"
#include <string.h>

/* Above this energy, per target measure, another start may do better: ratios off by one in a hundred. */
static const PetscReal fair_energy = 1e-4;

enum { MOST_ATTEMPTS = 8 };

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

/* Is there a reason to try another start? What a user has limited is left as it is. */
static PetscBool IsDisappointing(EqmSolver solver)
{
  const EqmImageTotals *const totals = &solver->iterate->totals;

  if (solver->status == EQM_STATUS_STOPPED || solver->limited) return PETSC_FALSE;
  if (totals->folds > 0) return PETSC_TRUE;
  if (solver->problem->terms) return PETSC_FALSE; /* equal ratios are not all that is wanted */
  return (PetscBool)(solver->problem->objective->poor_energy > 0. && totals->energy > fair_energy * totals->total);
}

/* Fewer folds, or as many and a lower objective. */
static PetscBool IsBetter(const struct _p_EqmIterate *a, const struct _p_EqmIterate *b)
{
  if (a->totals.folds != b->totals.folds) return (PetscBool)(a->totals.folds < b->totals.folds);
  return (PetscBool)(a->totals.energy < b->totals.energy);
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

/* From another start. */
static PetscErrorCode TryStart(EqmSolver solver, const EqmStartType *start, PetscInt count, PetscReal *tried)
{
  Attempt other = {.status = EQM_STATUS_NOT_CONVERGED, .start = start};
  PetscBool begun;

  PetscFunctionBegin;
  PetscCall(Tell(solver, start->name));
  PetscCall(EqmIterateCreate(solver->problem, &other.iterate));
  PetscCall(Exchange(solver, &other));
  PetscCall(Begin(solver, count, tried, &begun));
  if (begun) PetscCall(EqmSolverRun(solver));
  if (!begun || (solver->status != EQM_STATUS_STOPPED && !IsBetter(solver->iterate, other.iterate)))
    PetscCall(Exchange(solver, &other));
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

PetscErrorCode EqmSolverTryOtherStarts(EqmSolver solver)
{
  const EqmFormulation *const formulation = solver->formulation;
  const EqmSolverSettings first = solver->settings;
  const size_t suffix = solver->checkpoints.suffix;
  char *names = NULL, *rest;
  PetscInt attempt = 1;
  PetscReal tried[MOST_ATTEMPTS];

  PetscFunctionBegin;
  if (!HasOtherStarts(solver)) PetscFunctionReturn(0);
  PetscCall(PetscStrallocpy(formulation->other_starts, &names));
  tried[0] = solver->num_history > 0 ? solver->history[0].energy : -1.;
  for (char *name = strtok_r(names, ",", &rest); name && attempt < MOST_ATTEMPTS && IsDisappointing(solver);
       name = strtok_r(NULL, ",", &rest)) {
    const EqmStartType *start;

    PetscCall(EqmStartFind(solver->comm, formulation->starts, formulation->domain, name, &start));
    PetscCall(SetStage(solver, &first, suffix, ++attempt));
    PetscCall(TryStart(solver, start, attempt - 1, tried));
  }
  PetscCall(PetscFree(names));
  if (attempt == 1) PetscFunctionReturn(0);
  PetscCall(SetStage(solver, &first, suffix, 1));
  if (solver->status == EQM_STATUS_NOT_CONVERGED && !solver->limited)
    PetscCall(PetscStrlcat(solver->message, "; other starts did no better", sizeof(solver->message)));
  PetscFunctionReturn(0);
}
