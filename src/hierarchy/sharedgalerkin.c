/* Galerkin products of rows that are dealt to the ranks: each rank adds up what its rows give to coarse rows, and sends
   these to their owners, who add up what comes from several. */
#include "hierarchy/sharedrows.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sort.h"

/* A block on its way. */
typedef struct {
  PetscInt row, column;
  EqmBlock entry;
} Item;

/* What a rank's part of the product needs. */
typedef struct {
  const EqmSharedRows *a, *p;
  PetscInt num_ghosts, *ghost;  /* columns of A that other ranks have as rows, ascending */
  EqmSharedRows ghost_rows;     /* of P, for these */
  PetscInt num_coarse, *coarse; /* coarse rows that the rank's rows give to, ascending */
  PetscInt *begin, *from;       /* of coarse row j: from[begin[j]] .. are its entries in P */
  PetscInt *row;                /* per entry of P: its row there */
} Product;

static PetscErrorCode FindGhosts(Product *t)
{
  const EqmSharedRows *const a = t->a;
  const PetscInt end = a->first + a->num_rows;
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass == 1) PetscCall(PetscMalloc1(n, &t->ghost));
    n = 0;
    for (PetscInt q = 0; q < a->start[a->num_rows]; q++) {
      if (a->column[q] < 0 || (a->column[q] >= a->first && a->column[q] < end)) continue;
      if (pass == 1) t->ghost[n] = a->column[q];
      n++;
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&n, t->ghost));
  t->num_ghosts = n;
  PetscFunctionReturn(0);
}

/* Rows of P for the ghosts; all rows of P have the same number of blocks. Collective. */
static PetscErrorCode FetchGhostRows(MPI_Comm comm, Product *t)
{
  const EqmSharedRows *const p = t->p;
  PetscInt width = p->num_rows > 0 ? p->start[1] : 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &width, 1, MPIU_INT, MPI_MAX, comm));
  PetscCall(EqmSharedRowsCreate(comm, t->num_ghosts, width, &t->ghost_rows));
  PetscCall(EqmFetchRows(comm, p->num_rows, t->num_ghosts, t->ghost, MPIU_INT, width, p->column, t->ghost_rows.column));
  PetscCall(EqmFetchRows(comm, p->num_rows, t->num_ghosts, t->ghost, MPIU_REAL,
                         width * (PetscInt)(sizeof(EqmBlock) / sizeof(PetscReal)), p->entry, t->ghost_rows.entry));
  PetscFunctionReturn(0);
}

/* P by columns. */
static PetscErrorCode Transpose(Product *t)
{
  const EqmSharedRows *const p = t->p;
  const PetscInt length = p->start[p->num_rows];
  PetscInt n = 0, at;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(length, &t->coarse, length, &t->from, length, &t->row));
  for (PetscInt i = 0; i < p->num_rows; i++) {
    for (PetscInt q = p->start[i]; q < p->start[i + 1]; q++) {
      t->row[q] = i;
      if (p->column[q] >= 0) t->coarse[n++] = p->column[q];
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&n, t->coarse));
  t->num_coarse = n;
  PetscCall(PetscCalloc1(n + 2, &t->begin));
  for (PetscInt pass = 0; pass < 2; pass++) {
    for (PetscInt q = 0; q < length; q++) {
      if (p->column[q] < 0) continue;
      PetscCall(PetscFindInt(p->column[q], n, t->coarse, &at));
      if (pass == 0)
        t->begin[at + 2]++;
      else
        t->from[t->begin[at + 1]++] = q;
    }
    for (PetscInt j = 0; j < n && pass == 0; j++) t->begin[j + 2] += t->begin[j + 1];
  }
  PetscFunctionReturn(0);
}

/* The row of P for a column of A. */
static PetscErrorCode RowOf(const Product *t, PetscInt column, const EqmSharedRows **rows, PetscInt *i)
{
  PetscFunctionBegin;
  *i = column - t->a->first;
  *rows = t->p;
  if (*i < 0 || *i >= t->a->num_rows) {
    PetscCall(PetscFindInt(column, t->num_ghosts, t->ghost, i));
    *rows = &t->ghost_rows;
  }
  PetscFunctionReturn(0);
}

/* Add half * (row i of P) to the items begin .. *end - 1, which are a coarse row's. */
static void AddRow(const EqmBlock *half, const EqmSharedRows *rows, PetscInt i, PetscInt coarse, Item *items,
                   PetscInt begin, PetscInt *end)
{
  for (PetscInt r = rows->start[i]; r < rows->start[i + 1]; r++) {
    PetscInt at = begin;
    if (rows->column[r] < 0) continue;
    while (at < *end && items[at].column != rows->column[r]) at++;
    if (at == *end) items[(*end)++] = (Item){.row = coarse, .column = rows->column[r], .entry = {{0., 0., 0., 0.}}};
    EqmBlockAddProduct(half, &rows->entry[r], &items[at].entry);
  }
}

/* What this rank's rows give to the product. */
static PetscErrorCode Multiply(const Product *t, PetscInt *num, Item **out)
{
  const EqmSharedRows *const a = t->a, *const p = t->p;
  PetscInt room = 0, n = 0;
  Item *items = NULL;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < t->num_coarse; j++) {
    const PetscInt begin = n;
    for (PetscInt k = t->begin[j]; k < t->begin[j + 1]; k++) {
      const PetscInt i = t->row[t->from[k]];
      for (PetscInt q = a->start[i]; q < a->start[i + 1]; q++) {
        EqmBlock half = {{0., 0., 0., 0.}};
        const EqmSharedRows *rows;
        PetscInt of;
        if (a->column[q] < 0) continue;
        PetscCall(RowOf(t, a->column[q], &rows, &of));
        if (n + rows->start[of + 1] - rows->start[of] > room) {
          room = room + room / 2 + 16 * t->num_coarse;
          PetscCall(PetscRealloc(room * sizeof(*items), &items));
        }
        EqmBlockAddTransposedProduct(&p->entry[t->from[k]], &a->entry[q], &half);
        AddRow(&half, rows, of, t->coarse[j], items, begin, &n);
      }
    }
  }
  *num = n;
  *out = items;
  PetscFunctionReturn(0);
}

static int CompareColumns(const void *left, const void *right)
{
  const PetscInt a = ((const Item *)left)->column, b = ((const Item *)right)->column;

  return a < b ? -1 : a > b;
}

/* To the owners of the rows. Collective. */
static PetscErrorCode Send(MPI_Comm comm, PetscInt first, PetscInt num, const Item *items, PetscInt *num_arrived,
                           Item **arrived)
{
  PetscMPIInt size, *to, p = 0;
  PetscInt *range;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc2(num, &to, size + 1, &range));
  PetscCallMPI(MPI_Allgather(&first, 1, MPIU_INT, range, 1, MPIU_INT, comm));
  range[size] = PETSC_MAX_INT;
  for (PetscInt k = 0; k < num; k++) { /* rows ascend */
    while (items[k].row >= range[p + 1]) p++;
    to[k] = p;
  }
  PetscCall(EqmExchangeBytes(comm, num, sizeof(*items), to, items, num_arrived, arrived));
  PetscCall(PetscFree2(to, range));
  PetscFunctionReturn(0);
}

/* Rows of what came, those of one place added up. */
static PetscErrorCode Assemble(PetscInt num, const Item *items, EqmSharedRows *c)
{
  PetscInt *begin, at = 0;
  Item *sorted;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(c->num_rows + 2, &begin));
  PetscCall(PetscMalloc1(num, &sorted));
  for (PetscInt k = 0; k < num; k++) begin[items[k].row - c->first + 2]++;
  for (PetscInt i = 0; i < c->num_rows; i++) begin[i + 2] += begin[i + 1];
  for (PetscInt k = 0; k < num; k++) sorted[begin[items[k].row - c->first + 1]++] = items[k];
  PetscCall(PetscMalloc1(num, &c->column));
  PetscCall(PetscMalloc1(num, &c->entry));
  for (PetscInt i = 0; i < c->num_rows; i++) {
    c->start[i] = at;
    EqmSort(sorted + begin[i], (size_t)(begin[i + 1] - begin[i]), sizeof(*sorted), CompareColumns);
    for (PetscInt k = begin[i]; k < begin[i + 1]; k++) {
      if (k > begin[i] && sorted[k].column == sorted[k - 1].column) {
        for (int e = 0; e < 4; e++) c->entry[at - 1].e[e] += sorted[k].entry.e[e];
        continue;
      }
      c->column[at] = sorted[k].column;
      c->entry[at++] = sorted[k].entry;
    }
  }
  c->start[c->num_rows] = at;
  PetscCall(PetscFree(begin));
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedGalerkin(MPI_Comm comm, const EqmSharedRows *a, const EqmSharedRows *p, PetscInt num_columns,
                                 EqmSharedRows *product)
{
  Product t = {.a = a, .p = p};
  PetscInt num, num_arrived;
  Item *items, *arrived;

  PetscFunctionBegin;
  PetscCall(FindGhosts(&t));
  PetscCall(FetchGhostRows(comm, &t));
  PetscCall(Transpose(&t));
  PetscCall(Multiply(&t, &num, &items));
  PetscCall(EqmSharedRowsDestroy(&t.ghost_rows));
  PetscCall(PetscFree(t.ghost));
  PetscCall(PetscFree(t.begin));
  PetscCall(PetscFree3(t.coarse, t.from, t.row));
  PetscCall(EqmSharedRowsCreate(comm, num_columns, 0, product));
  PetscCall(Send(comm, product->first, num, items, &num_arrived, &arrived));
  PetscCall(PetscFree(items));
  PetscCall(PetscFree(product->column));
  PetscCall(PetscFree(product->entry));
  PetscCall(Assemble(num_arrived, arrived, product));
  PetscCall(PetscFree(arrived));
  PetscFunctionReturn(0);
}
