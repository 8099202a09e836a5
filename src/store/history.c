/* The history of a run as CSV: a header and one row per iteration. */
#include "store.h"
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

static PetscErrorCode WriteOnRoot(EqmMap map, const char *name, char *message, size_t length)
{
  EqmAtomicFile file;
  PetscErrorCode error = EqmAtomicOpen(name, &file, message, length);

  if (error) return error;
  EqmAtomicPrint(&file, "iteration,energy,sd,folds,step,gradient_norm,evaluations,factorizations,"
                        "coupled_factorizations,solves,seconds\n");
  for (PetscInt i = 0; i < map->num_history; i++) PrintRow(&file, &map->history[i]);
  return EqmAtomicCommit(&file, message, length);
}

/* Write the history as CSV, all digits, whole or not at all. Errors: EQM_ERR_IO on all ranks. Collective; rank 0
   writes. */
PetscErrorCode EqmMapWriteHistory(EqmMap map, const char *file)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(map->soup->comm, &rank));
  if (rank == 0) error = WriteOnRoot(map, file, message, sizeof(message));
  PetscCall(EqmAgree(map->soup->comm, error, message));
  PetscFunctionReturn(0);
}
