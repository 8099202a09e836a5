/* A rank's part of a level: its vertices, the cells around them, and who else has a say in these. */
#include "hierarchy/shared.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sort.h"
#include <stdlib.h>

/* A cell on its way: its corners' numbers along the curve; where it comes from. */
typedef struct {
  PetscInt corner[3], place;
  PetscReal weight;
} Cell;

static PetscMPIInt Owner(PetscMPIInt size, const PetscInt *range, PetscInt number)
{
  PetscMPIInt low = 0, high = size;

  while (high - low > 1) {
    const PetscMPIInt middle = low + (high - low) / 2;
    if (range[middle] <= number)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Every cell to the owners of its corners. Collective. */
static PetscErrorCode SendCells(const EqmSharedSource *source, const PetscInt *number, const PetscInt *range,
                                PetscInt *num, Cell **cells)
{
  PetscMPIInt size, *to;
  PetscInt sent = 0;
  Cell *cell;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(source->comm, &size));
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass == 1) PetscCall(PetscMalloc2(sent, &cell, sent, &to));
    sent = 0;
    for (PetscInt c = 0; c < source->num_cells; c++) {
      PetscMPIInt owner[3];
      if (source->dead && source->dead[c]) continue;
      for (PetscInt a = 0; a < 3; a++) owner[a] = Owner(size, range, number[source->cells[3 * c + a]]);
      for (PetscInt a = 0; a < 3; a++) {
        if ((a > 0 && owner[a] == owner[0]) || (a > 1 && owner[a] == owner[1])) continue;
        if (pass == 1) {
          to[sent] = owner[a];
          cell[sent].weight = source->weight[c];
          cell[sent].place = source->place ? source->place[c] : -1;
          for (PetscInt b = 0; b < 3; b++) cell[sent].corner[b] = number[source->cells[3 * c + b]];
        }
        sent++;
      }
    }
  }
  PetscCall(EqmExchangeBytes(source->comm, sent, sizeof(*cell), to, cell, num, cells));
  PetscCall(PetscFree2(cell, to));
  PetscFunctionReturn(0);
}

static void SortedCorners(const Cell *cell, PetscInt sorted[3])
{
  const PetscInt *const v = cell->corner;

  sorted[0] = PetscMin(v[0], PetscMin(v[1], v[2]));
  sorted[2] = PetscMax(v[0], PetscMax(v[1], v[2]));
  sorted[1] = v[0] != sorted[0] && v[0] != sorted[2] ? v[0] : v[1] != sorted[0] && v[1] != sorted[2] ? v[1] : v[2];
}

/* By the lowest corner, then the next. */
static int CompareCells(const void *left, const void *right)
{
  PetscInt a[3], b[3];

  SortedCorners(left, a);
  SortedCorners(right, b);
  for (PetscInt k = 0; k < 3; k++) {
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  }
  return 0;
}

/* `order`: the cells by their corners; begin[1 + v] .. begin[2 + v] - 1 of it have their lowest at the owned vertex v,
   begin[0] .. begin[1] - 1 at another rank's. */
static PetscErrorCode SortCells(const EqmSharedLevel *to, PetscInt num, Cell *cells, PetscInt **begin_of)
{
  PetscInt *begin, *lowest;
  Cell *sorted;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(to->num_owned + 3, &begin));
  PetscCall(PetscMalloc2(num, &lowest, num, &sorted));
  for (PetscInt c = 0; c < num; c++) {
    const PetscInt *const v = cells[c].corner;
    lowest[c] = PetscMax(0, PetscMin(v[0], PetscMin(v[1], v[2])) - to->first + 1);
    begin[lowest[c] + 2]++;
  }
  for (PetscInt k = 0; k < to->num_owned + 1; k++) begin[k + 2] += begin[k + 1];
  for (PetscInt c = 0; c < num; c++) sorted[begin[lowest[c] + 1]++] = cells[c];
  for (PetscInt k = 0; k < to->num_owned + 1; k++)
    EqmSort(sorted + begin[k], (size_t)(begin[k + 1] - begin[k]), sizeof(*sorted), CompareCells);
  PetscCall(PetscArraycpy(cells, sorted, num));
  PetscCall(PetscFree2(lowest, sorted));
  *begin_of = begin;
  PetscFunctionReturn(0);
}

/* Ghosts: the corners that other ranks own. Collective. */
static PetscErrorCode FindGhosts(EqmSharedLevel *to, PetscInt num, const Cell *cells)
{
  const PetscInt end = to->first + to->num_owned;
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass == 1) PetscCall(PetscMalloc1(n, &to->ghost));
    n = 0;
    for (PetscInt k = 0; k < 3 * num; k++) {
      const PetscInt v = cells[k / 3].corner[k % 3];
      if (v >= to->first && v < end) continue;
      if (pass == 1) to->ghost[n] = v;
      n++;
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&n, to->ghost));
  PetscCall(PetscRealloc(n * sizeof(PetscInt), &to->ghost));
  to->level.num_vertices = to->num_owned + n;
  PetscCall(EqmRowsCreateSF(to->comm, to->num_owned, n, to->ghost, &to->halo));
  PetscFunctionReturn(0);
}

/* Where the cells come from. */
static PetscErrorCode TakeOrder(EqmSharedLevel *to, PetscInt num, const Cell *cells)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num, &to->cell_order));
  for (PetscInt c = 0; c < num; c++) to->cell_order[c] = cells[c].place;
  PetscFunctionReturn(0);
}

/* Corners in local numbers. */
static PetscErrorCode TakeCells(EqmSharedLevel *to, PetscInt num, const Cell *cells, const PetscInt *begin)
{
  EqmHierarchyLevel *const level = &to->level;
  const PetscInt ghosts = level->num_vertices - to->num_owned;

  PetscFunctionBegin;
  level->num_cells = num;
  PetscCall(PetscMalloc1(3 * num, &level->cells));
  PetscCall(PetscMalloc1(num, &level->weight));
  for (PetscInt c = 0; c < num; c++) {
    level->weight[c] = cells[c].weight;
    for (PetscInt a = 0; a < 3; a++) {
      PetscInt v = cells[c].corner[a] - to->first, at;
      if (v < 0 || v >= to->num_owned) {
        PetscCall(PetscFindInt(cells[c].corner[a], ghosts, to->ghost, &at));
        v = to->num_owned + at;
      }
      level->cells[3 * c + a] = v;
    }
  }
  to->num_foreign_cells = begin[1];
  PetscCall(PetscMalloc1(to->num_pieces + 1, &to->cell_start));
  for (PetscInt k = 0; k <= to->num_pieces; k++) to->cell_start[k] = begin[to->vertex_start[k] + 1];
  num -= to->num_foreign_cells;
  PetscCall(MPIU_Allreduce(&num, &to->num_cells, 1, MPIU_INT, MPI_SUM, to->comm));
  PetscFunctionReturn(0);
}

/* Places and parts, from the finer level. Collective. */
static PetscErrorCode TakeVertices(const EqmSharedSource *source, EqmSharedLevel *to)
{
  EqmHierarchyLevel *const level = &to->level;
  PetscInt boundary = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * level->num_vertices, &level->position));
  PetscCall(PetscMalloc1(level->num_vertices, &level->part));
  PetscCall(EqmRowsToLeaves(to->from_finer, 3, source->position, level->position));
  PetscCall(EqmSharedUpdateGhosts(to, 3, level->position));
  PetscCall(PetscSFBcastBegin(to->from_finer, MPI_UNSIGNED_CHAR, source->part, level->part, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(to->from_finer, MPI_UNSIGNED_CHAR, source->part, level->part, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(to->halo, MPI_UNSIGNED_CHAR, level->part, level->part + to->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(to->halo, MPI_UNSIGNED_CHAR, level->part, level->part + to->num_owned, MPI_REPLACE));
  for (PetscInt v = 0; v < to->num_owned; v++) boundary += level->part[v] != EQM_INSIDE;
  PetscCall(MPIU_Allreduce(&boundary, &to->num_boundary, 1, MPIU_INT, MPI_SUM, to->comm));
  /* here: gaps in the triangles around vertices; each triangle around a ghost may be followed by one */
  for (PetscInt k = 0; k < 3 * level->num_cells; k++) boundary += level->cells[k] >= to->num_owned;
  level->num_boundary = boundary;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedLevelCreate(const EqmSharedSource *source, PetscInt where, PetscInt vertices_of_piece,
                                    EqmSharedLevel *to)
{
  PetscInt *number, *range, *begin, num;
  PetscMPIInt size;
  Cell *cells;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(to, sizeof(*to)));
  to->comm = source->comm;
  PetscCallMPI(MPI_Comm_size(to->comm, &size));
  PetscCall(PetscMalloc2(source->num_local, &number, size + 1, &range));
  PetscCall(EqmSharedNumber(source, where, vertices_of_piece, to, number, range));
  PetscCall(SendCells(source, number, range, &num, &cells));
  PetscCall(PetscFree2(number, range));
  PetscCall(SortCells(to, num, cells, &begin));
  PetscCall(FindGhosts(to, num, cells));
  PetscCall(TakeCells(to, num, cells, begin));
  if (source->place) PetscCall(TakeOrder(to, num, cells));
  PetscCall(PetscFree(cells));
  PetscCall(PetscFree(begin));
  PetscCall(TakeVertices(source, to));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedLevelDestroy(EqmSharedLevel *level)
{
  PetscFunctionBegin;
  PetscCall(EqmLevelReset(&level->level));
  PetscCall(PetscFree(level->ghost));
  PetscCall(PetscFree(level->cell_order));
  PetscCall(PetscFree(level->vertex_start));
  PetscCall(PetscFree(level->cell_start));
  PetscCall(PetscFree(level->record_start));
  PetscCall(PetscSFDestroy(&level->halo));
  PetscCall(PetscSFDestroy(&level->from_finer));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedUpdateGhosts(const EqmSharedLevel *level, PetscInt width, PetscReal *array)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(level->halo, width, array, array + width * level->num_owned));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedSum(const EqmSharedLevel *level, PetscInt width, const PetscReal *piece, PetscReal *sum)
{
  PetscMPIInt size, *count, *start;
  PetscReal *all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(level->comm, &size));
  PetscCall(PetscMalloc3(size, &count, size, &start, width * level->num_all_pieces, &all));
  for (PetscMPIInt p = 0; p < size; p++) {
    const PetscInt begin = (PetscInt)((PetscInt64)level->num_all_pieces * p / size),
                   end = (PetscInt)((PetscInt64)level->num_all_pieces * (p + 1) / size);
    PetscCall(PetscMPIIntCast(width * begin, &start[p]));
    PetscCall(PetscMPIIntCast(width * (end - begin), &count[p]));
  }
  PetscCallMPI(MPI_Allgatherv(piece, (PetscMPIInt)(width * level->num_pieces), MPIU_REAL, all, count, start, MPIU_REAL,
                              level->comm));
  for (PetscInt k = 0; k < width; k++) sum[k] = 0.;
  for (PetscInt k = 0; k < width * level->num_all_pieces; k++) sum[k % width] += all[k];
  PetscCall(PetscFree3(count, start, all));
  PetscFunctionReturn(0);
}
