#include "hierarchy/sharedrows.h"

PetscErrorCode EqmSharedRowsCreate(MPI_Comm comm, PetscInt num_rows, PetscInt width, EqmSharedRows *rows)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  *rows = (EqmSharedRows){.num_rows = num_rows};
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Exscan(&num_rows, &rows->first, 1, MPIU_INT, MPI_SUM, comm));
  if (rank == 0) rows->first = 0;
  PetscCall(PetscMalloc1(num_rows + 1, &rows->start));
  PetscCall(PetscMalloc1(width * num_rows, &rows->column));
  PetscCall(PetscMalloc1(width * num_rows, &rows->entry));
  for (PetscInt i = 0; i <= num_rows; i++) rows->start[i] = width * i;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedRowsDestroy(EqmSharedRows *rows)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rows->start));
  PetscCall(PetscFree(rows->column));
  PetscCall(PetscFree(rows->entry));
  PetscFunctionReturn(0);
}

/* A block row with ascending columns. Returns how many. */
static PetscInt SortRow(PetscInt begin, PetscInt end, const PetscInt *column, PetscInt *place)
{
  PetscInt n = 0;

  for (PetscInt q = begin; q < end; q++) {
    PetscInt at = n;
    if (column[q] < 0) continue;
    for (; at > 0 && column[place[at - 1]] > column[q]; at--) place[at] = place[at - 1];
    place[at] = q;
    n++;
  }
  return n;
}

PetscErrorCode EqmSharedRowsMatrix(MPI_Comm comm, const EqmSharedRows *rows, PetscInt num_columns, Mat *matrix)
{
  const PetscInt n = rows->num_rows;
  PetscInt *row, *column, *place, most = 0, at = 0;
  PetscReal *value;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) most = PetscMax(most, rows->start[i + 1] - rows->start[i]);
  PetscCall(PetscMalloc1(most, &place));
  PetscCall(PetscMalloc3(2 * n + 1, &row, 4 * rows->start[n], &column, 4 * rows->start[n], &value));
  row[0] = 0;
  for (PetscInt i = 0; i < n; i++) {
    const PetscInt num = SortRow(rows->start[i], rows->start[i + 1], rows->column, place);
    for (PetscInt k = 0; k < 2; k++) {
      for (PetscInt q = 0; q < 2 * num; q++) {
        const PetscReal e = rows->entry[place[q / 2]].e[2 * k + q % 2];
        if (e == 0.) continue;
        column[at] = 2 * rows->column[place[q / 2]] + q % 2;
        value[at++] = e;
      }
      row[2 * i + k + 1] = at;
    }
  }
  PetscCall(MatCreateMPIAIJWithArrays(comm, 2 * n, 2 * num_columns, PETSC_DETERMINE, PETSC_DETERMINE, row, column,
                                      value, matrix));
  PetscCall(PetscFree3(row, column, value));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(0);
}
