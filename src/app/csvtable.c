/* Tables of figures per cell or vertex. */
#include "csvtable.h"
#include "base/atomicfile.h"
#include "base/rows.h"

/* A table of reals per cell or vertex: `num` rows of `width` on rank 0. */
typedef struct {
  const char *header;
  PetscInt num, width;
  PetscReal *values;
} Table;

static void PrintTable(EqmAtomicFile *file, void *context)
{
  const Table *const table = context;

  EqmAtomicPrint(file, "%s\n", table->header);
  for (PetscInt i = 0; i < table->num; i++) {
    EqmAtomicPrint(file, "%" PetscInt_FMT ",", i);
    EqmAtomicPrintReals(file, table->width, table->values + (size_t)table->width * (size_t)i, ',');
    EqmAtomicPrint(file, "\n");
  }
}

PetscErrorCode EqmCsvTableWrite(MPI_Comm comm, const char *file, const char *header, PetscInt num, PetscInt count,
                                const PetscReal *first, const PetscReal *second)
{
  Table table = {.header = header, .num = num, .width = second ? 2 : 1};
  PetscReal *rows;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc2(table.width * count, &rows, rank == 0 ? table.width * num : 0, &table.values));
  for (PetscInt i = 0; i < count; i++) {
    rows[table.width * i] = first[i];
    if (second) rows[table.width * i + 1] = second[i];
  }
  PetscCall(EqmFetchSlab(comm, count, rank == 0 ? num : 0, 0, MPIU_REAL, table.width, rows, table.values));
  PetscCall(EqmAtomicPrintFile(comm, file, PrintTable, &table));
  PetscCall(PetscFree2(rows, table.values));
  PetscFunctionReturn(0);
}
