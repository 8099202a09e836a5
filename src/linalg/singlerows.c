#include "linalg/singlerows.h"
#include "linalg/linalg.h"
#include "base/rows.h"
#include <omp.h>

enum { SIDE = 3 };

PetscErrorCode EqmSingleRowsFit(Mat matrix, PetscBool *fit)
{
  PetscInt rows, columns;
  PetscBool mine;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(matrix, &rows, &columns));
  mine = (PetscBool)(rows % SIDE == 0 && columns % SIDE == 0);
  PetscCall(MPIU_Allreduce(&mine, fit, 1, MPIU_BOOL, MPI_LAND, PetscObjectComm((PetscObject)matrix)));
  PetscFunctionReturn(0);
}

/* ---- pattern */

/* Number the blocks among the columns that other ranks have. */
static PetscErrorCode MakeGhosts(Mat matrix, const EqmBlocks *blocks, EqmSingleRows *rows)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)matrix);
  PetscInt *number, n = 0;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(blocks->num_global_columns, &rows->ghost_of));
  PetscCall(PetscMalloc1(blocks->num_global_columns, &number));
  for (PetscInt c = 0; c < blocks->num_global_columns; c++) {
    const PetscInt block = blocks->global_column[c] / SIDE;
    if (n == 0 || number[n - 1] != block) number[n++] = block;
    rows->ghost_of[c] = rows->num_columns + n - 1;
  }
  rows->num_ghosts = n;
  PetscCall(EqmRowsCreateSF(comm, rows->num_columns, n, number, &rows->halo));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

static inline PetscInt BlockOf(const EqmSingleRows *rows, int part, PetscInt column)
{
  return part == 0 ? column / SIDE : rows->ghost_of[column];
}

/* The blocks of a row, whose number is returned; `seen`, per column: the last row that had it. */
static PetscInt ListRow(const EqmBlocks *blocks, const EqmSingleRows *rows, PetscInt i, PetscBool with_diagonal,
                        PetscInt *seen, PetscInt *column)
{
  PetscInt n = 0;

  for (int part = 0; part < 2 && blocks->block[part]; part++) {
    for (PetscInt q = blocks->start[part][SIDE * i]; q < blocks->start[part][SIDE * (i + 1)]; q++) {
      const PetscInt block = BlockOf(rows, part, blocks->column[part][q]);
      if (seen[block] == i) continue;
      seen[block] = i;
      column[n++] = block;
    }
  }
  if (with_diagonal && seen[i] != i) column[n++] = i;
  return n;
}

PetscErrorCode EqmSingleRowsCreate(Mat matrix, PetscBool with_diagonal, EqmSingleRows *rows)
{
  EqmBlocks blocks;
  PetscInt num_rows, num_columns, *seen, *column;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(matrix, &num_rows, &num_columns));
  *rows = (EqmSingleRows){.num_rows = num_rows / SIDE, .num_columns = num_columns / SIDE};
  PetscCall(EqmBlocksGet(matrix, &blocks));
  PetscCall(MakeGhosts(matrix, &blocks, rows));
  const PetscInt n = rows->num_columns + rows->num_ghosts;
  PetscCall(PetscMalloc2(n, &seen, n, &column));
  PetscCall(PetscMalloc1(rows->num_rows + 1, &rows->start));
  for (PetscInt c = 0; c < n; c++) seen[c] = -1;
  rows->start[0] = 0;
  for (PetscInt i = 0; i < rows->num_rows; i++)
    rows->start[i + 1] = rows->start[i] + ListRow(&blocks, rows, i, with_diagonal, seen, column);
  const PetscInt length = rows->start[rows->num_rows];
  PetscCall(PetscMalloc1(length, &rows->column));
  PetscCall(PetscCalloc1((size_t)EQM_SINGLE_BLOCK * (size_t)length + SIDE, &rows->entry));
  for (PetscInt c = 0; c < n; c++) seen[c] = -1;
  for (PetscInt i = 0; i < rows->num_rows; i++) {
    PetscInt *const mine = rows->column + rows->start[i];
    const PetscInt length_of_row = ListRow(&blocks, rows, i, with_diagonal, seen, mine);
    PetscBool sorted; /* as a rule */
    PetscCall(PetscSortedInt(length_of_row, mine, &sorted));
    if (!sorted) PetscCall(PetscSortInt(length_of_row, mine));
  }
  PetscCall(EqmBlocksRestore(&blocks));
  PetscCall(PetscFree2(seen, column));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleRowsDestroy(EqmSingleRows *rows)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rows->start));
  PetscCall(PetscFree(rows->column));
  PetscCall(PetscFree(rows->ghost_of));
  PetscCall(PetscFree(rows->entry));
  PetscCall(PetscSFDestroy(&rows->halo));
  PetscFunctionReturn(0);
}

/* ---- entries */

/* `place`, per column: scratch. */
static PetscBool FillRow(const EqmBlocks *blocks, PetscInt i, PetscInt *place, EqmSingleRows *rows)
{
  PetscBool finite = PETSC_TRUE;

  for (PetscInt q = rows->start[i]; q < rows->start[i + 1]; q++) {
    place[rows->column[q]] = q;
    for (PetscInt k = 0; k < EQM_SINGLE_BLOCK; k++) rows->entry[EQM_SINGLE_BLOCK * q + k] = 0.F;
  }
  for (int part = 0; part < 2 && blocks->block[part]; part++) {
    for (PetscInt k = 0; k < SIDE; k++) {
      for (PetscInt q = blocks->start[part][SIDE * i + k]; q < blocks->start[part][SIDE * i + k + 1]; q++) {
        const PetscInt column = blocks->column[part][q], block = BlockOf(rows, part, column);
        const PetscInt within = part == 0 ? column % SIDE : blocks->global_column[column] % SIDE;
        const float value = (float)blocks->value[part][q];
        rows->entry[EQM_SINGLE_BLOCK * place[block] + SIDE * within + k] = value;
        if (!isfinite(value)) finite = PETSC_FALSE;
      }
    }
  }
  return finite;
}

PetscErrorCode EqmSingleRowsFill(Mat matrix, EqmSingleRows *rows, PetscBool *finite)
{
  const PetscInt n = rows->num_columns + rows->num_ghosts;
  const int num_threads = omp_get_max_threads();
  PetscInt *place;
  EqmBlocks blocks;
  int bad = 0;

  PetscFunctionBegin;
  PetscCall(EqmBlocksGet(matrix, &blocks));
  PetscCall(PetscMalloc1(num_threads * n, &place));
#pragma omp parallel for schedule(static) num_threads(num_threads) reduction(| : bad)
  for (PetscInt i = 0; i < rows->num_rows; i++) bad |= !FillRow(&blocks, i, place + omp_get_thread_num() * n, rows);
  PetscCall(PetscFree(place));
  PetscCall(EqmBlocksRestore(&blocks));
  *finite = (PetscBool)!bad;
  PetscFunctionReturn(0);
}

void EqmSingleRowsScale(float factor, EqmSingleRows *rows)
{
  const PetscInt count = EQM_SINGLE_BLOCK * rows->start[rows->num_rows];

  for (PetscInt k = 0; k < count; k++) rows->entry[k] *= factor;
}

/* ---- products */

PetscErrorCode EqmSingleRowsUpdateGhosts(const EqmSingleRows *rows, float *x)
{
  PetscFunctionBegin;
  if (rows->halo)
    PetscCall(EqmRowsOfToLeaves(rows->halo, MPI_FLOAT, EQM_SINGLE_WIDTH, x, x + EQM_SINGLE_WIDTH * rows->num_columns));
  PetscFunctionReturn(0);
}

EQM_CLONES static void MultiplyRange(const EqmSingleRows *rows, PetscInt begin, PetscInt end, const float *x,
                                     PetscBool add, float *y)
{
  for (PetscInt i = begin; i < end; i++) {
    float *const to = y + EQM_SINGLE_WIDTH * i;
    Single4 sum = EqmSingleProduct(rows, rows->start[i], rows->start[i + 1], x);
    if (add) sum += EqmSingleLoad(to);
    EqmSingleStore(to, sum);
  }
}

void EqmSingleRowsMultiply(const EqmSingleRows *rows, const float *x, PetscBool add, float *y)
{
  enum { ROWS_AT_ONCE = 512 };
  const PetscInt count = (rows->num_rows + ROWS_AT_ONCE - 1) / ROWS_AT_ONCE;

#pragma omp parallel for schedule(static) if (count > 4)
  for (PetscInt k = 0; k < count; k++)
    MultiplyRange(rows, ROWS_AT_ONCE * k, PetscMin(ROWS_AT_ONCE * (k + 1), rows->num_rows), x, add, y);
}
