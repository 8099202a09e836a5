/* One run of a map command on one mesh, and the second one that a repair may ask for. */
#include "maprun.h"
#include "mesh/mesh_private.h"
#include "base/quiet.h"
#include "base/rows.h"
#include "solver/inner.h"
#include "store/map_private.h"
#include <string.h>

PetscErrorCode EqmMapRunDestroy(EqmMapRun *run)
{
  PetscFunctionBegin;
  if (run->map != run->found) PetscCall(EqmMapDestroy(&run->map));
  PetscCall(EqmMapDestroy(&run->found));
  PetscCall(EqmSolverDestroy(&run->solver));
  PetscCall(EqmMeshDestroy(&run->mesh));
  PetscCall(PetscMemzero(run, sizeof(*run)));
  PetscFunctionReturn(0);
}

/* Mesh and solver with its options. */
static PetscErrorCode Begin(const char *command, const EqmIntake *input, const EqmStopFile *stop_file, EqmLedger ledger,
                            EqmMapRun *run)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(run, sizeof(*run)));
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmMeshCreate(input->mapped, ledger, &run->mesh));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_DISTRIBUTE));
  PetscCall(EqmSolverCreate(run->mesh, command, &run->solver));
  PetscCall(EqmSolverSetMonitor(run->solver, EqmSolverMonitorText, NULL));
  PetscCall(EqmSolverSetFromOptions(run->solver));
  PetscCall(EqmSolverSetStopFile(run->solver, stop_file));
  PetscFunctionReturn(0);
}

static PetscErrorCode Finish(const EqmIntake *input, EqmLedger ledger, EqmMapRun *run)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverSolve(run->solver));
  PetscCall(EqmSolverGetMap(run->solver, input->mapped, &run->found));
  PetscCall(EqmIntakeTakeMap(input, run->mesh, run->found, &run->map));
  PetscCall(EqmIntakeMeasureGiven(input, ledger, run->found, run->map));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapRunSolve(const char *command, const EqmIntake *input, const EqmStopFile *stop_file,
                              EqmLedger ledger, EqmMapRun *run)
{
  PetscFunctionBegin;
  PetscCall(Begin(command, input, stop_file, ledger, run));
  PetscCall(Finish(input, ledger, run));
  PetscFunctionReturn(0);
}

/* ---- without splits */

/* The map of the split mesh becomes the first one: vertices that splits have added are the last. */
static PetscErrorCode ContinueFrom(EqmMap found, EqmSoup whole, EqmMapRun *run)
{
  const PetscInt dim = found->dim, num_slab = found->soup->vertex_end - found->soup->vertex_start;
  PetscReal *slab, *x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(dim * (whole->vertex_end - whole->vertex_start), &slab, dim * run->mesh->num_local, &x));
  PetscCall(EqmFetchSlab(whole->comm, num_slab, whole->vertex_end - whole->vertex_start, whole->vertex_start, MPIU_REAL,
                         dim, found->coordinates, slab));
  PetscCall(EqmMeshVerticesFromInput(run->mesh, whole, dim, slab, x));
  PetscCall(EqmSolverSetFirstMap(run->solver, dim, x));
  PetscCall(PetscFree2(slab, x));
  PetscFunctionReturn(0);
}

/* Fewer folds of the file's cells; or as many, and areas or, where these are kept, angles more like the file's. */
static PetscBool IsBetter(const char *command, EqmMap a, EqmMap b)
{
  const PetscBool keeps_angles = (PetscBool)!strcmp(command, "conformal");

  if (a->status == EQM_STATUS_STOPPED) return PETSC_TRUE; /* the run is not over */
  if (a->distortion.folds + a->boundary_folds != b->distortion.folds + b->boundary_folds)
    return (PetscBool)(a->distortion.folds + a->boundary_folds < b->distortion.folds + b->boundary_folds);
  if (keeps_angles) return (PetscBool)(a->distortion.angle_error.mean < b->distortion.angle_error.mean);
  return (PetscBool)(a->distortion.energy < b->distortion.energy);
}

/* A run on the file's own cells, the `stage`-th minimisation: from the start, or from the map of the split mesh. */
static PetscErrorCode SolveWhole(const char *command, const EqmIntake *whole, const EqmStopFile *stop_file,
                                 EqmLedger ledger, PetscInt stage, EqmMap from, EqmMapRun *run)
{
  PetscFunctionBegin;
  PetscCall(Begin(command, whole, stop_file, ledger, run));
  PetscCall(EqmSolverSetStage(run->solver, stage));
  if (from) PetscCall(ContinueFrom(from, whole->mapped, run));
  PetscCall(Finish(whole, ledger, run));
  PetscFunctionReturn(0);
}

/* Such a run, whose map takes the place of the best so far if it is better. `good` - it has no folds. That the method
   cannot do without the splits is no failure. */
static PetscErrorCode TryWhole(const char *command, const EqmIntakeOptions *options, const EqmIntake *whole,
                               const EqmStopFile *stop_file, EqmLedger ledger, PetscInt stage, EqmMapRun *run,
                               PetscBool *good)
{
  char message[EQM_MESSAGE_MAX] = "";
  const EqmMap from = stage > 2 ? run->found : NULL;
  const EqmDistortion *const now = &run->map->distortion;
  PetscErrorCode error;
  EqmMapRun next = {0};

  PetscFunctionBegin;
  if (!options->quiet)
    PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                          "the file's own cells: energy %.3e, %" PetscInt64_FMT " folds; once more without splits%s\n",
                          (double)now->energy, now->folds, from ? ", from this map" : ""));
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  error = SolveWhole(command, whole, stop_file, ledger, stage, from, &next);
  PetscCall(PetscPopErrorHandler());
  *good = (PetscBool)(!error && next.map->distortion.folds + next.map->boundary_folds == 0);
  if (error && !options->quiet) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "the splits are needed: %s\n", message));
  if (!error && IsBetter(command, next.map, run->map)) {
    const EqmMapRun other = *run;
    *run = next;
    next = other;
  } else if (!error && !options->quiet) {
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "this is no better for the file's own cells: the map before is kept\n"));
  }
  PetscCall(EqmMapRunDestroy(&next));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapRunWithoutSplits(const char *command, const EqmIntakeOptions *options, const EqmIntake *input,
                                      const EqmStopFile *stop_file, EqmLedger ledger, EqmMapRun *run, EqmIntake *whole)
{
  PetscBool can, good;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(whole, sizeof(*whole)));
  if (!input->repair.cells_split || run->map->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  PetscCall(EqmIntakeWithoutSplits(options, input, whole, &can));
  if (!can) PetscFunctionReturn(0);
  PetscCall(TryWhole(command, options, whole, stop_file, ledger, 2, run, &good));
  if (good || run->map->status == EQM_STATUS_STOPPED) PetscFunctionReturn(0);
  /* the corners of a square may be others on the other mesh: nothing to go on from */
  if (!strcmp(command, "square") || run->map->distortion.folds + run->map->boundary_folds > 0) PetscFunctionReturn(0);
  PetscCall(TryWhole(command, options, whole, stop_file, ledger, 3, run, &good));
  PetscFunctionReturn(0);
}
