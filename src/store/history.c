/* The history of a run as CSV: a header and one row per iteration. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "base/atomicfile.h"

static void PrintRow(EqmAtomicFile *file, const EqmHistoryRow *row)
{
  const PetscReal quality[2] = {row->energy, row->sd}, step[2] = {row->step, row->gradient_norm};

  EqmAtomicPrint(file, "%" PetscInt_FMT ",", row->iteration);
  EqmAtomicPrintReals(file, 2, quality, ',');
  EqmAtomicPrint(file, ",%" PetscInt64_FMT ",", row->folds);
  EqmAtomicPrintReals(file, 2, step, ',');
  EqmAtomicPrint(file, ",%" PetscInt64_FMT ",%" PetscInt64_FMT ",%" PetscInt64_FMT ",%" PetscInt64_FMT ",",
                 row->work.evaluations, row->work.factorizations, row->work.coupled_factorizations, row->work.solves);
  EqmAtomicPrintReals(file, 1, &row->seconds, ',');
  EqmAtomicPrint(file, "\n");
}

static void PrintHistory(EqmAtomicFile *file, void *context)
{
  const EqmMap map = context;

  EqmAtomicPrint(file, "iteration,energy,sd,folds,step,gradient_norm,evaluations,factorizations,"
                       "coupled_factorizations,solves,seconds\n");
  for (PetscInt i = 0; i < map->num_history; i++) PrintRow(file, &map->history[i]);
}

/* Write the history as CSV, all digits, whole or not at all. Errors: EQM_ERR_IO on all ranks. Collective; rank 0
   writes. */
PetscErrorCode EqmMapWriteHistory(EqmMap map, const char *file)
{
  PetscFunctionBegin;
  PetscCall(EqmAtomicPrintFile(map->soup->comm, file, PrintHistory, map));
  PetscFunctionReturn(0);
}
