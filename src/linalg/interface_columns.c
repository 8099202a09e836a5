/* Right-hand sides and solutions on their way between the fronts of a tree of ranks: rows are dealt as those of the
   fronts, all columns are in the first column of a grid. */
#include "linalg/interface_route.h"

/* The rows of group `side` that the k-th rank of its grid's first column has, as far as the `to`-th of the front's has
   their places: numbers among the former's rows, and among the latter's. */
typedef struct {
  PetscInt count, *from, *to;
} Rows;

static PetscErrorCode CreateRows(const EqmFront *front, PetscMPIInt side, PetscMPIInt k, PetscMPIInt to, Rows *rows)
{
  EqmStrip strip;

  PetscFunctionBegin;
  PetscCall(EqmStripCreate(front, side, front->from_grid[side].rows, k, &strip));
  PetscCall(EqmStripSelect(front, &strip, to, EqmRowOwner, &rows->count, &rows->from));
  PetscCall(PetscMalloc1(rows->count, &rows->to));
  for (PetscInt r = 0; r < rows->count; r++) rows->to[r] = EqmLocalRow(front, strip.place[rows->from[r]]);
  PetscCall(EqmStripDestroy(&strip));
  PetscFunctionReturn(0);
}

static PetscErrorCode DestroyRows(Rows *rows)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(rows->from));
  PetscCall(PetscFree(rows->to));
  PetscFunctionReturn(0);
}

static PetscBool IsInFirstColumn(EqmGrid grid, PetscMPIInt rank)
{
  return (PetscBool)(EqmGridHas(grid, rank) && EqmGridColumn(grid, rank) == 0);
}

/* Columns of `stride` numbers, these rows of them, one column after the other. */
static PetscScalar *PackRows(PetscInt count, const PetscInt *row, PetscInt num_rhs, PetscInt stride,
                             const PetscScalar *columns, PetscScalar *packed)
{
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < count; k++) *packed++ = columns[(size_t)c * (size_t)stride + (size_t)row[k]];
  }
  return packed;
}

PetscErrorCode EqmInterfaceRaise(EqmInterface tree, EqmFront *front, PetscInt num_rhs, const EqmPassed *passed)
{
  const EqmGrid grid = front->grid;
  EqmSending sending = {0};
  Rows rows;

  PetscFunctionBegin;
  if (IsInFirstColumn(passed->grid, tree->rank)) {
    const PetscMPIInt mine = EqmGridRow(passed->grid, tree->rank);
    const PetscInt count = EqmDealtCount(passed->n, passed->grid.block, passed->grid.rows, mine);
    PetscCall(
        EqmSendingCreate((size_t)count * (size_t)num_rhs, grid.rows, grid.first, grid.columns, EQM_TAG_UP, &sending));
    PetscScalar *next = sending.packed;
    for (PetscMPIInt to = 0; to < grid.rows; to++) {
      sending.begin[to] = (size_t)(next - sending.packed);
      PetscCall(CreateRows(front, front->side, mine, to, &rows));
      next = PackRows(rows.count, rows.from, num_rhs, passed->stride, passed->values, next);
      PetscCall(DestroyRows(&rows));
    }
    sending.begin[grid.rows] = (size_t)(next - sending.packed);
  }
  PetscCall(EqmSendingBegin(tree, &sending));
  for (PetscMPIInt side = 0; side < 2 && IsInFirstColumn(grid, tree->rank); side++) {
    const EqmGrid from = front->from_grid[side];
    for (PetscMPIInt k = 0; k < from.rows; k++) {
      PetscScalar *buffer;
      const PetscScalar *next;
      PetscCall(CreateRows(front, side, k, EqmGridRow(grid, tree->rank), &rows));
      PetscCall(EqmSendingReceive(tree, EqmGridRank(from, k, 0), EQM_TAG_UP, &sending, &buffer, &next));
      for (PetscInt c = 0; c < num_rhs; c++) {
        for (PetscInt r = 0; r < rows.count; r++)
          front->columns[(size_t)c * (size_t)front->rows + (size_t)rows.to[r]] += *next++;
      }
      PetscCall(PetscFree(buffer));
      PetscCall(DestroyRows(&rows));
    }
  }
  PetscCall(EqmSendingEnd(&sending));
  PetscFunctionReturn(0);
}

/* The solution at the rows of one group, for the ranks of its grid's first column. */
static PetscErrorCode SendDown(EqmInterface tree, const EqmFront *front, PetscMPIInt side, PetscInt num_rhs,
                               EqmSending *sending)
{
  const EqmGrid grid = front->from_grid[side];
  PetscScalar *next;

  PetscFunctionBegin;
  *sending = (EqmSending){0};
  if (!IsInFirstColumn(front->grid, tree->rank)) PetscFunctionReturn(0);
  PetscCall(EqmSendingCreate((size_t)PetscMin(front->rows, front->num_from[side]) * (size_t)num_rhs, grid.rows,
                             grid.first, grid.columns, EQM_TAG_DOWN, sending));
  next = sending->packed;
  for (PetscMPIInt k = 0; k < grid.rows; k++) {
    Rows rows;
    sending->begin[k] = (size_t)(next - sending->packed);
    PetscCall(CreateRows(front, side, k, EqmGridRow(front->grid, tree->rank), &rows));
    next = PackRows(rows.count, rows.to, num_rhs, front->rows, front->columns, next);
    PetscCall(DestroyRows(&rows));
  }
  sending->begin[grid.rows] = (size_t)(next - sending->packed);
  PetscCall(EqmSendingBegin(tree, sending));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceLower(EqmInterface tree, EqmFront *front, PetscInt num_rhs, EqmPassed *passed)
{
  const EqmGrid grid = front->grid;
  EqmSending sending[2];

  PetscFunctionBegin;
  for (PetscMPIInt side = 0; side < 2; side++) PetscCall(SendDown(tree, front, side, num_rhs, &sending[side]));
  for (PetscMPIInt k = 0; k < grid.rows && IsInFirstColumn(passed->grid, tree->rank); k++) {
    PetscScalar *buffer;
    const PetscScalar *next;
    Rows rows;
    PetscCall(CreateRows(front, front->side, EqmGridRow(passed->grid, tree->rank), k, &rows));
    PetscCall(EqmSendingReceive(tree, EqmGridRank(grid, k, 0), EQM_TAG_DOWN, &sending[front->side], &buffer, &next));
    for (PetscInt c = 0; c < num_rhs; c++) {
      for (PetscInt r = 0; r < rows.count; r++)
        passed->values[(size_t)c * (size_t)passed->stride + (size_t)rows.from[r]] = *next++;
    }
    PetscCall(PetscFree(buffer));
    PetscCall(DestroyRows(&rows));
  }
  for (int side = 0; side < 2; side++) PetscCall(EqmSendingEnd(&sending[side]));
  PetscFunctionReturn(0);
}
