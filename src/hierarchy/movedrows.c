#include "hierarchy/movedrows.h"
#include "base/rows.h"

/* Where each row begins, here and where it comes from; then a leaf for each block. Collective. */
static PetscErrorCode FindEntries(PetscSF rows, const EqmBlockMatrix *from, EqmMovedRows *to)
{
  EqmBlockMatrix *const matrix = &to->matrix;
  const PetscInt n = matrix->num_rows;
  const PetscSFNode *source;
  PetscSFNode *remote;
  PetscInt *begin, *end;
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n + 1, &matrix->start));
  PetscCall(PetscMalloc2(n, &begin, n, &end));
  PetscCall(EqmRowsOfToLeaves(rows, MPIU_INT, 1, from->start, begin));
  PetscCall(EqmRowsOfToLeaves(rows, MPIU_INT, 1, from->start + 1, end));
  matrix->start[0] = 0;
  for (PetscInt i = 0; i < n; i++) matrix->start[i + 1] = matrix->start[i] + end[i] - begin[i];
  PetscCall(PetscSFGetGraph(rows, NULL, NULL, NULL, &source));
  PetscCall(PetscMalloc1(matrix->start[n], &remote));
  for (PetscInt i = 0, at = 0; i < n; i++) {
    for (PetscInt q = begin[i]; q < end[i]; q++) remote[at++] = (PetscSFNode){.rank = source[i].rank, .index = q};
  }
  PetscCall(PetscFree2(begin, end));
  PetscCall(PetscObjectGetComm((PetscObject)rows, &comm));
  PetscCall(PetscSFCreate(comm, &to->entries));
  PetscCall(PetscSFSetGraph(to->entries, from->start[from->num_rows], matrix->start[n], NULL, PETSC_OWN_POINTER, remote,
                            PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(to->entries));
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
  PetscInt *column, n, first = 0;
  const PetscInt length = from->start[from->num_rows];
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCall(PetscObjectGetComm((PetscObject)rows, &comm));
  PetscCall(PetscSFGetGraph(rows, NULL, &n, NULL, NULL));
  *to = (EqmMovedRows){.matrix = {.num_rows = n}};
  PetscCall(FindEntries(rows, from, to));
  PetscCall(PetscMalloc1(to->matrix.start[n], &to->matrix.column));
  PetscCall(PetscMalloc1(to->matrix.start[n], &to->matrix.entry));
  PetscCall(PetscMalloc1(length, &column));
  for (PetscInt q = 0; q < length; q++) column[q] = number[from->column[q]];
  PetscCall(EqmRowsOfToLeaves(to->entries, MPIU_INT, 1, column, to->matrix.column));
  PetscCall(PetscFree(column));
  PetscCallMPI(MPI_Scan(&n, &first, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(FindGhosts(first - n, to));
  PetscCall(NumberColumns(first - n, to));
  PetscCall(EqmRowsCreateSF(comm, n, to->num_ghosts, to->ghost, &to->halo));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMovedRowsDestroy(EqmMovedRows *to)
{
  PetscFunctionBegin;
  PetscCall(EqmBlockMatrixReset(&to->matrix));
  PetscCall(PetscFree(to->ghost));
  PetscCall(PetscSFDestroy(&to->halo));
  PetscCall(PetscSFDestroy(&to->entries));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMovedRowsFill(const EqmBlockMatrix *from, EqmMovedRows *to)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsOfToLeaves(to->entries, MPIU_REAL, 4, from->entry, to->matrix.entry));
  PetscFunctionReturn(0);
}
