/* The history of a run as CSV: a header and one row per iteration. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/columns.h"
#include "store/store.h"
#include "base/atomicfile.h"

static void PrintRow(EqmAtomicFile *file, const EqmHistoryRow *row)
{
  EqmAtomicPrint(file, "%" PetscInt_FMT, row->iteration);
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) {
    const EqmHistoryColumn *const column = &EqmHistoryColumns[k];
    EqmAtomicPrint(file, ",");
    if (column->is_count)
      EqmAtomicPrint(file, "%" PetscInt64_FMT, *(const PetscInt64 *)EqmHistoryEntry(row, column));
    else
      EqmAtomicPrintReals(file, 1, EqmHistoryEntry(row, column), ',');
  }
  EqmAtomicPrint(file, "\n");
}

static void PrintHistory(EqmAtomicFile *file, void *context)
{
  const EqmMap map = context;

  EqmAtomicPrint(file, "iteration");
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) EqmAtomicPrint(file, ",%s", EqmHistoryColumns[k].name);
  EqmAtomicPrint(file, "\n");
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
