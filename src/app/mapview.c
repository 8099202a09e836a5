/* What a run of a map command tells at its end: a table, and the Hessian's eigenvalues. */
#include "maprun.h"
#include "mesh/soup_private.h"
#include <string.h>

/* What it took. */
static PetscErrorCode PrintWork(MPI_Comm comm, const EqmMapCost *cost)
{
  char cycles[96] = "";

  PetscFunctionBegin;
  if (cost->work.set_ups > 0)
    PetscCall(PetscSNPrintf(cycles, sizeof(cycles),
                            " by %" PetscInt64_FMT " cycles with %" PetscInt64_FMT " set-ups of the hierarchy",
                            cost->work.cg_iterations, cost->work.set_ups));
  PetscCall(PetscPrintf(comm,
                        "  work          %" PetscInt64_FMT " evaluations, %" PetscInt64_FMT
                        " factorisations (%" PetscInt64_FMT " coupled), %" PetscInt64_FMT " solves%s\n",
                        cost->work.evaluations, cost->work.factorizations, cost->work.coupled_factorizations,
                        cost->work.solves, cycles));
  PetscCall(PetscPrintf(comm,
                        "  seconds       %.2f: read %.2f, diagnose %.2f, distribute %.2f, start %.2f, minimise %.2f, "
                        "measure %.2f, write %.2f\n",
                        (double)cost->total_seconds, (double)cost->phase_seconds[EQM_PHASE_READ],
                        (double)cost->phase_seconds[EQM_PHASE_DIAGNOSE],
                        (double)cost->phase_seconds[EQM_PHASE_DISTRIBUTE], (double)cost->phase_seconds[EQM_PHASE_START],
                        (double)cost->phase_seconds[EQM_PHASE_MINIMISE], (double)cost->phase_seconds[EQM_PHASE_MEASURE],
                        (double)cost->phase_seconds[EQM_PHASE_WRITE]));
  PetscCall(PetscPrintf(comm,
                        "  of these      METIS %.2f, assembly %.2f, factorisation %.2f, solves %.2f, kernels %.2f\n",
                        (double)cost->event_seconds[EQM_EVENT_PARTITION],
                        (double)cost->event_seconds[EQM_EVENT_ASSEMBLE], (double)cost->event_seconds[EQM_EVENT_FACTOR],
                        (double)cost->event_seconds[EQM_EVENT_SOLVE], (double)cost->event_seconds[EQM_EVENT_KERNEL]));
  PetscFunctionReturn(0);
}

/* The prepared mesh that was mapped in place of the file's. */
static PetscErrorCode PrintPrepared(MPI_Comm comm, EqmMap prepared)
{
  const EqmDistortion *d;
  PetscReal final;

  PetscFunctionBegin;
  if (!prepared) PetscFunctionReturn(0);
  PetscCall(EqmMapGetDistortion(prepared, &d));
  PetscCall(EqmMapGetEnergies(prepared, NULL, &final));
  PetscCall(PetscPrintf(comm,
                        "  prepared mesh energy %.6e   sd %.3e   min %.4g   max %.4g   folds %" PetscInt64_FMT "\n",
                        (double) final, (double)d->ratio.sd, (double)d->ratio.min, (double)d->ratio.max, d->folds));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapPrintResult(PetscBool ended, const char *written, EqmMap map, EqmMap prepared)
{
  const EqmDistortion *d;
  const EqmMapCost *cost;
  const char *message;
  PetscReal initial, final;
  PetscInt64 boundary_folds;
  EqmSoup soup;
  EqmStatus status;
  MPI_Comm comm = PETSC_COMM_WORLD;

  PetscFunctionBegin;
  PetscCall(EqmMapGetDistortion(map, &d));
  PetscCall(EqmMapGetCost(map, &cost));
  PetscCall(EqmMapGetStatus(map, &status, &message));
  PetscCall(EqmMapGetEnergies(map, &initial, &final));
  PetscCall(EqmMapGetBoundaryFolds(map, &boundary_folds));
  PetscCall(EqmMapGetSoup(map, &soup));
  const PetscBool is_solid = (PetscBool)(soup->cell_size == 4);
  PetscCall(PetscPrintf(comm,
                        "\n%s, %" PetscInt_FMT " vertices, %" PetscInt_FMT " cells, %" PetscInt_FMT
                        " rank%s x %" PetscInt_FMT " thread%s\n",
                        soup->file, soup->num_vertices, soup->num_cells, cost->ranks, cost->ranks == 1 ? "" : "s",
                        cost->threads, cost->threads == 1 ? "" : "s"));
  if (ended || (prepared && status == EQM_STATUS_FOLDS))
    PetscCall(PetscPrintf(comm, "  %s: %s\n", EqmStatusName(status), message));
  PetscCall(PetscPrintf(comm, "  energy        %.6e   (start %.3e)\n", (double) final, (double)initial));
  PetscCall(EqmMapViewRatios(map));
  if (!is_solid)
    PetscCall(PetscPrintf(comm, "  angle error   mean %.2f   median %.2f degrees\n", (double)d->angle_error.mean,
                          (double)d->angle_error.p50));
  PetscCall(PetscPrintf(comm, "  folds         %" PetscInt64_FMT, d->folds));
  if (is_solid) PetscCall(PetscPrintf(comm, "   on the boundary %" PetscInt64_FMT, boundary_folds));
  PetscCall(PetscPrintf(comm, "\n"));
  PetscCall(PrintPrepared(comm, prepared));
  PetscCall(PrintWork(comm, cost));
  PetscCall(PetscPrintf(comm, "  memory        %.0f MB in all\n  written       %s\n", 1e-6 * (double)cost->memory_total,
                        written));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapTakeEigenvalues(PetscInt wanted, const char *hessian, EqmLedger ledger, EqmSolver solver,
                                     EqmMap map)
{
  PetscReal *values;
  PetscInt found;

  PetscFunctionBegin;
  if (wanted == 0) PetscFunctionReturn(0);
  PetscCall(EqmPhaseBegin(ledger, EQM_PHASE_MEASURE));
  PetscCall(PetscMalloc1(wanted, &values));
  PetscCall(strcmp(hessian, "energy") ? EqmSolverStretchHessianEigenvalues(solver, wanted, values, &found)
                                      : EqmSolverHessianEigenvalues(solver, wanted, values, &found));
  PetscCall(EqmMapAddText(map, "hessian", hessian));
  PetscCall(EqmMapSetHessianEigenvalues(map, found, values));
  PetscCall(EqmPhaseEnd(ledger, EQM_PHASE_MEASURE));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\nsmallest eigenvalues of the Hessian:"));
  for (PetscInt k = 0; k < found; k++) PetscCall(PetscPrintf(PETSC_COMM_WORLD, " %.4e", (double)values[k]));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, found < wanted ? " (the others not found)\n" : "\n"));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(0);
}
