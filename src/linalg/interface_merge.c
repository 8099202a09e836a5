/* What two groups of ranks pass on becomes a front. Within a group every entry has a place of its own: sums depend on
   the order of the groups alone. */
#include "linalg/interface_route.h"

typedef struct {
  const EqmPassed *passed;
  PetscScalar *next;
} Packing;

static void Pack(void *context, const EqmRun *run)
{
  Packing *const packing = context;
  const PetscScalar *const column = packing->passed->values + (size_t)run->column * (size_t)packing->passed->stride;

  for (PetscInt k = 0; k < run->count; k++) {
    if (EqmIsInRun(run, run->row[k])) *packing->next++ = column[run->row[k]];
  }
}

/* Where the entries go: local rows and columns of the panel and of what is passed on, per place. */
typedef struct {
  const EqmFront *front;
  PetscInt *row, *column;
  PetscScalar *rest;
  const PetscScalar *next;
} Adding;

static void Add(void *context, const EqmRun *run)
{
  Adding *const adding = context;
  const EqmFront *const front = adding->front;
  const PetscInt at = run->columns->place[run->column];

  for (PetscInt k = 0; k < run->count; k++) {
    if (!EqmIsInRun(run, run->row[k])) continue;
    const PetscInt other = run->rows->place[run->row[k]], a = run->turned ? at : other, b = run->turned ? other : at;
    if (b < front->num_out)
      front->panel[(size_t)adding->column[b] * (size_t)front->rows + (size_t)adding->row[a]] += *adding->next++;
    else
      adding->rest[(size_t)adding->column[b] * (size_t)front->kept_rows +
                   (size_t)(adding->row[a] - (front->rows - front->kept_rows))] += *adding->next++;
  }
}

/* Pack this rank's part of the triangle for all ranks of the front. */
static PetscErrorCode PackTriangle(EqmInterface tree, const EqmFront *front, const EqmPassed *passed,
                                   EqmSending *sending)
{
  const EqmGrid grid = passed->grid;
  Packing packing = {.passed = passed};
  EqmStrip rows, columns;
  size_t entries = 0;

  PetscFunctionBegin;
  *sending = (EqmSending){0};
  if (!EqmGridHas(grid, tree->rank)) PetscFunctionReturn(0);
  PetscCall(EqmStripCreate(front, front->side, grid.rows, EqmGridRow(grid, tree->rank), &rows));
  PetscCall(EqmStripCreate(front, front->side, grid.columns, EqmGridColumn(grid, tree->rank), &columns));
  for (PetscInt c = 0, r = 0; c < columns.count; c++) {
    while (r < rows.count && rows.index[r] < columns.index[c]) r++;
    entries += (size_t)(rows.count - r);
  }
  PetscCall(EqmSendingCreate(entries, EqmGridSize(front->grid), front->grid.first, 1, EQM_TAG_MATRIX, sending));
  packing.next = sending->packed;
  for (PetscMPIInt k = 0; k < sending->count; k++) {
    sending->begin[k] = (size_t)(packing.next - sending->packed);
    PetscCall(EqmForEachRun(front, &rows, &columns, front->grid.first + k, Pack, &packing));
  }
  sending->begin[sending->count] = (size_t)(packing.next - sending->packed);
  PetscCall(EqmStripDestroy(&rows));
  PetscCall(EqmStripDestroy(&columns));
  PetscFunctionReturn(0);
}

/* Add what the ranks of one group have sent. */
static PetscErrorCode AddGroup(EqmInterface tree, EqmFront *front, PetscMPIInt side, const EqmSending *sending,
                               Adding *adding)
{
  const EqmGrid grid = front->from_grid[side];

  PetscFunctionBegin;
  for (PetscMPIInt k = 0; k < EqmGridSize(grid); k++) {
    PetscScalar *buffer;
    EqmStrip rows, columns;
    PetscCall(EqmStripCreate(front, side, grid.rows, k / grid.columns, &rows));
    PetscCall(EqmStripCreate(front, side, grid.columns, k % grid.columns, &columns));
    PetscCall(EqmSendingReceive(tree, grid.first + k, EQM_TAG_MATRIX, sending, &buffer, &adding->next));
    PetscCall(EqmForEachRun(front, &rows, &columns, tree->rank, Add, adding));
    PetscCall(PetscFree(buffer));
    PetscCall(EqmStripDestroy(&rows));
    PetscCall(EqmStripDestroy(&columns));
  }
  PetscFunctionReturn(0);
}

/* The panel, once, and the matrix that this front passes on, both zero. */
static PetscErrorCode AllocateFront(EqmFront *front, PetscScalar **rest)
{
  const size_t size = (size_t)front->rows * (size_t)front->out_columns;

  PetscFunctionBegin;
  if (!front->panel) PetscCall(PetscMalloc1(size, &front->panel));
  PetscCall(PetscArrayzero(front->panel, size));
  PetscCall(PetscCalloc1((size_t)front->kept_rows * (size_t)front->kept_columns, rest));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceMerge(EqmInterface tree, EqmFront *front, EqmPassed *passed)
{
  const PetscInt size = front->num_out + front->num_kept;
  Adding adding = {.front = front};
  EqmSending sending;

  PetscFunctionBegin;
  PetscCall(PackTriangle(tree, front, passed, &sending));
  PetscCall(PetscFree(passed->values));
  PetscCall(EqmSendingBegin(tree, &sending));
  if (EqmFrontHas(front, tree->rank)) {
    PetscCall(AllocateFront(front, &adding.rest));
    PetscCall(PetscMalloc2(size, &adding.row, size, &adding.column));
    for (PetscInt p = 0; p < size; p++) {
      adding.row[p] = EqmLocalRow(front, p);
      adding.column[p] = EqmLocalColumn(front, p);
    }
    for (PetscMPIInt side = 0; side < 2; side++) PetscCall(AddGroup(tree, front, side, &sending, &adding));
    PetscCall(PetscFree2(adding.row, adding.column));
  }
  PetscCall(EqmSendingEnd(&sending));
  *passed = (EqmPassed){front->grid, front->num_kept, front->kept_rows, adding.rest};
  PetscFunctionReturn(0);
}
