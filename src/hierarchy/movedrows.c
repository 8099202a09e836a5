#include "hierarchy/movedrows.h"
#include "base/rows.h"

/* Fewer rows are not worth the threads. */
enum { LEAST_ROWS = 4096 };

/* Where each row begins, here and where it comes from. Collective. */
static PetscErrorCode FindRows(PetscSF rows, const EqmBlockMatrix *from, EqmMovedRows *to)
{
  EqmBlockMatrix *const matrix = &to->matrix;
  const PetscInt n = matrix->num_rows;
  PetscInt *end;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n + 1, &matrix->start));
  PetscCall(PetscMalloc1(n, &to->begin));
  PetscCall(PetscMalloc1(n, &end));
  PetscCall(EqmRowsOfToLeaves(rows, MPIU_INT, 1, from->start, to->begin));
  PetscCall(EqmRowsOfToLeaves(rows, MPIU_INT, 1, from->start + 1, end));
  matrix->start[0] = 0;
  for (PetscInt i = 0; i < n; i++) matrix->start[i + 1] = matrix->start[i] + end[i] - to->begin[i];
  PetscCall(PetscFree(end));
  PetscFunctionReturn(0);
}

/* A leaf for each block. Collective. */
static PetscErrorCode FindEntries(PetscSF rows, const EqmBlockMatrix *from, EqmMovedRows *to)
{
  const PetscInt n = to->matrix.num_rows, *const start = to->matrix.start;
  const PetscSFNode *source;
  PetscSFNode *remote;
  PetscMPIInt size;
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm((PetscObject)rows, &comm));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) PetscFunctionReturn(0);
  PetscCall(PetscSFGetGraph(rows, NULL, NULL, NULL, &source));
  PetscCall(PetscMalloc1(start[n], &remote));
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt q = start[i]; q < start[i + 1]; q++)
      remote[q] = (PetscSFNode){.rank = source[i].rank, .index = to->begin[i] + q - start[i]};
  }
  PetscCall(PetscSFCreate(comm, &to->entries));
  PetscCall(PetscSFSetGraph(to->entries, from->start[from->num_rows], start[n], NULL, PETSC_OWN_POINTER, remote,
                            PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(to->entries));
  PetscFunctionReturn(0);
}

/* Numbers of the blocks' columns. Collective. */
static PetscErrorCode FetchColumns(const EqmBlockMatrix *from, const PetscInt *number, EqmMovedRows *to)
{
  EqmBlockMatrix *const matrix = &to->matrix;
  const PetscInt n = matrix->num_rows, length = from->start[from->num_rows];
  PetscInt *column;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(matrix->start[n], &matrix->column));
  PetscCall(PetscMalloc1(length, &column));
  for (PetscInt q = 0; q < length; q++) column[q] = number[from->column[q]];
  if (to->entries) PetscCall(EqmRowsOfToLeaves(to->entries, MPIU_INT, 1, column, matrix->column));
  for (PetscInt i = 0; i < n && !to->entries; i++)
    PetscCall(PetscArraycpy(matrix->column + matrix->start[i], column + to->begin[i],
                            matrix->start[i + 1] - matrix->start[i]));
  PetscCall(PetscFree(column));
  PetscFunctionReturn(0);
}

/* Columns that other ranks own. */
static PetscErrorCode FindGhosts(PetscInt first, EqmMovedRows *to)
{
  const EqmBlockMatrix *const matrix = &to->matrix;
  const PetscInt length = matrix->start[matrix->num_rows], end = first + matrix->num_rows;
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass == 1) PetscCall(PetscMalloc1(n, &to->ghost));
    n = 0;
    for (PetscInt q = 0; q < length; q++) {
      if (matrix->column[q] >= first && matrix->column[q] < end) continue;
      if (pass == 1) to->ghost[n] = matrix->column[q];
      n++;
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&n, to->ghost));
  to->num_ghosts = n;
  PetscFunctionReturn(0);
}

/* Columns in local numbers; where the diagonal is. */
static PetscErrorCode NumberColumns(PetscInt first, EqmMovedRows *to)
{
  EqmBlockMatrix *const matrix = &to->matrix;
  const PetscInt n = matrix->num_rows;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &matrix->diagonal));
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt q = matrix->start[i]; q < matrix->start[i + 1]; q++) {
      PetscInt local = matrix->column[q] - first, at;
      if (local < 0 || local >= n) {
        PetscCall(PetscFindInt(matrix->column[q], to->num_ghosts, to->ghost, &at));
        local = n + at;
      }
      matrix->column[q] = local;
      if (local == i) matrix->diagonal[i] = q;
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMovedRowsCreate(PetscSF rows, const EqmBlockMatrix *from, const PetscInt *number, EqmMovedRows *to)
{
  PetscInt n, end = 0;
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm((PetscObject)rows, &comm));
  PetscCall(PetscSFGetGraph(rows, NULL, &n, NULL, NULL));
  *to = (EqmMovedRows){.matrix = {.num_rows = n}};
  PetscCall(FindRows(rows, from, to));
  PetscCall(FindEntries(rows, from, to));
  PetscCall(FetchColumns(from, number, to));
  PetscCall(PetscMalloc1(to->matrix.start[n], &to->matrix.entry));
  PetscCallMPI(MPI_Scan(&n, &end, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(FindGhosts(end - n, to));
  PetscCall(NumberColumns(end - n, to));
  PetscCall(EqmRowsCreateSF(comm, n, to->num_ghosts, to->ghost, &to->halo));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMovedRowsDestroy(EqmMovedRows *to)
{
  PetscFunctionBegin;
  PetscCall(EqmBlockMatrixReset(&to->matrix));
  PetscCall(PetscFree(to->ghost));
  PetscCall(PetscFree(to->begin));
  PetscCall(PetscSFDestroy(&to->halo));
  PetscCall(PetscSFDestroy(&to->entries));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMovedRowsFill(const EqmBlockMatrix *from, EqmMovedRows *to)
{
  EqmBlockMatrix *const matrix = &to->matrix;

  PetscFunctionBegin;
  if (to->entries) {
    PetscCall(EqmRowsOfToLeaves(to->entries, MPIU_REAL, 4, from->entry, matrix->entry));
    PetscFunctionReturn(0);
  }
#pragma omp parallel for schedule(static) if (matrix->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < matrix->num_rows; i++) {
    for (PetscInt q = matrix->start[i]; q < matrix->start[i + 1]; q++)
      matrix->entry[q] = from->entry[to->begin[i] + q - matrix->start[i]];
  }
  PetscFunctionReturn(0);
}
