/* A piece is taken out of its level, decimated, and put back. */
#include "hierarchy/sharedpiece.h"
#include "base/sort.h"
#include <stdlib.h>

/* The piece of this rank that an owned vertex is in. */
static PetscInt PieceOf(const EqmSharedLevel *shared, PetscInt vertex)
{
  return EqmSharedPiece(shared, shared->first + vertex) - shared->first_piece;
}

/* The pieces of this rank that a cell touches; returns how many. */
static PetscInt PiecesOf(const EqmSharedLevel *shared, PetscInt cell, PetscInt piece[3])
{
  PetscInt n = 0;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscInt v = shared->level.cells[3 * cell + a];
    if (v >= shared->num_owned) continue;
    piece[n] = PieceOf(shared, v);
    if ((n > 0 && piece[n] == piece[0]) || (n > 1 && piece[n] == piece[1])) continue;
    n++;
  }
  return n;
}

PetscErrorCode EqmPieceCellsCreate(const EqmSharedLevel *shared, EqmPieceCells *cells)
{
  PetscInt piece[3];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(shared->num_pieces + 2, &cells->start));
  for (PetscInt c = 0; c < shared->level.num_cells; c++) {
    for (PetscInt n = PiecesOf(shared, c, piece); n-- > 0;) cells->start[piece[n] + 2]++;
  }
  for (PetscInt k = 0; k < shared->num_pieces; k++) cells->start[k + 2] += cells->start[k + 1];
  PetscCall(PetscMalloc1(cells->start[shared->num_pieces + 1], &cells->item));
  for (PetscInt c = 0; c < shared->level.num_cells; c++) {
    for (PetscInt n = PiecesOf(shared, c, piece); n-- > 0;) cells->item[cells->start[piece[n] + 1]++] = c;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPieceCellsDestroy(EqmPieceCells *cells)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(cells->start));
  PetscCall(PetscFree(cells->item));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPieceWorkCreate(const EqmSharedLevel *shared, const EqmPieceCells *cells, EqmPieceWork *work)
{
  PetscInt n = 0, m = 0;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(work, sizeof(*work)));
  for (PetscInt k = 0; k < shared->num_pieces; k++) {
    const PetscInt count = cells->start[k + 1] - cells->start[k];
    m = PetscMax(m, count);
    n = PetscMax(n, shared->vertex_start[k + 1] - shared->vertex_start[k] + 2 * count);
  }
  n = PetscMin(n, shared->level.num_vertices);
  PetscCall(PetscMalloc2(3 * m, &work->level.cells, m, &work->level.weight));
  PetscCall(PetscMalloc2(3 * n, &work->level.position, n, &work->level.part));
  PetscCall(PetscMalloc2(2 * m + n, &work->vertex, n, &work->held));
  PetscCall(EqmDecimationCreate(n, m, &work->decimation));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPieceWorkDestroy(EqmPieceWork *work)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(work->level.cells, work->level.weight));
  PetscCall(PetscFree2(work->level.position, work->level.part));
  PetscCall(PetscFree2(work->vertex, work->held));
  PetscCall(EqmDecimationDestroy(&work->decimation));
  PetscFunctionReturn(0);
}

static int CompareIntegers(const void *left, const void *right)
{
  const PetscInt a = *(const PetscInt *)left, b = *(const PetscInt *)right;

  return a < b ? -1 : a > b;
}

/* The piece's vertices, then those around it, in ascending order of their local numbers. */
static void TakeVertices(const EqmSharedLevel *shared, PetscInt k, const EqmPieceCells *cells, EqmPieceWork *work)
{
  const EqmHierarchyLevel *const from = &shared->level;
  const PetscInt begin = shared->vertex_start[k], num = shared->vertex_start[k + 1] - begin;
  PetscInt n = num, around = num;

  for (PetscInt v = 0; v < num; v++) work->vertex[v] = begin + v;
  for (PetscInt q = cells->start[k]; q < cells->start[k + 1]; q++) {
    for (PetscInt a = 0; a < 3; a++) {
      const PetscInt v = from->cells[3 * cells->item[q] + a];
      if (v < begin || v >= begin + num) work->vertex[n++] = v;
    }
  }
  EqmSort(work->vertex + num, (size_t)(n - num), sizeof(PetscInt), CompareIntegers);
  for (PetscInt q = num; q < n; q++) {
    if (q == num || work->vertex[q] != work->vertex[around - 1]) work->vertex[around++] = work->vertex[q];
  }
  work->level.num_vertices = around;
  work->level.num_boundary = 0;
  for (PetscInt v = 0; v < around; v++) {
    for (PetscInt c = 0; c < 3; c++) work->level.position[3 * v + c] = from->position[3 * work->vertex[v] + c];
    work->level.part[v] = from->part[work->vertex[v]];
    work->level.num_boundary += v < num && work->level.part[v] != EQM_INSIDE;
    work->held[v] = v >= num;
  }
}

/* The cells; a vertex in a cell with one from around is held. */
static void TakeCells(const EqmSharedLevel *shared, PetscInt k, const EqmPieceCells *cells, EqmPieceWork *work)
{
  const EqmHierarchyLevel *const from = &shared->level;
  const PetscInt begin = shared->vertex_start[k], num = shared->vertex_start[k + 1] - begin;

  work->level.num_cells = cells->start[k + 1] - cells->start[k];
  for (PetscInt c = 0; c < work->level.num_cells; c++) {
    const PetscInt item = cells->item[cells->start[k] + c];
    PetscInt *const corner = work->level.cells + 3 * c, outside = 0;
    work->level.weight[c] = from->weight[item];
    for (PetscInt a = 0; a < 3; a++) {
      const PetscInt v = from->cells[3 * item + a];
      corner[a] = v - begin;
      if (v >= begin && v < begin + num) continue;
      const PetscInt *const found = EqmSearch(&v, work->vertex + num, (size_t)(work->level.num_vertices - num),
                                              sizeof(PetscInt), CompareIntegers);
      corner[a] = (PetscInt)(found - work->vertex);
      outside = 1;
    }
    for (PetscInt a = 0; a < 3 && outside; a++) work->held[corner[a]] = 1;
  }
}

/* Cells that are the piece's alone, and its vertices, as they are now; records in the level's numbers. */
static void PutBack(EqmSharedLevel *shared, PetscInt k, const EqmPieceCells *cells, const EqmPieceWork *work,
                    EqmSharedRest *rest)
{
  const EqmDecimation *const d = &work->decimation;
  const PetscInt begin = shared->vertex_start[k], num = shared->vertex_start[k + 1] - begin;
  const EqmHierarchyLevel *const level = &work->level;
  const PetscInt start = EQM_MOST_RECORD * begin;

  for (PetscInt c = 0; c < level->num_cells; c++) {
    const PetscInt item = cells->item[cells->start[k] + c], *const old = level->cells + 3 * c;
    if (old[0] >= num || old[1] >= num || old[2] >= num) continue;
    rest->dead[item] = d->dead[c];
    rest->weight[item] = d->weight[c];
    for (PetscInt a = 0; a < 3; a++) rest->cells[3 * item + a] = begin + d->cells[3 * c + a];
  }
  for (PetscInt v = 0; v < num; v++) rest->gone[begin + v] = d->gone[v];
  for (PetscInt r = 0; r < level->num_collapses; r++) {
    EqmCollapse *const record = &level->collapse[r];
    record->vertex += begin;
    record->onto += begin;
    record->start += start;
  }
  for (PetscInt q = 0; q < level->ring_length; q++) level->ring[q] += begin;
}

PetscInt EqmPieceDecimate(EqmSharedLevel *shared, PetscInt k, const EqmPieceCells *cells, PetscReal ratio,
                          PetscInt least_boundary, EqmPieceWork *work, EqmSharedRest *rest)
{
  const PetscInt begin = shared->vertex_start[k], num = shared->vertex_start[k + 1] - begin;
  EqmHierarchyLevel *const level = &work->level;
  PetscReal quality = .3, share;
  PetscInt held = 0, goal;

  level->collapse = shared->level.collapse + begin;
  level->ring = shared->level.ring + EQM_MOST_RECORD * begin;
  level->ring_weight = shared->level.ring_weight + EQM_MOST_RECORD * begin;
  TakeVertices(shared, k, cells, work);
  TakeCells(shared, k, cells, work);
  for (PetscInt v = 0; v < num; v++) held += work->held[v];
  goal = level->num_vertices - num + held + (PetscInt)((num - held) / ratio);
  share = (PetscReal)least_boundary / PetscMax(1, shared->num_boundary);
  EqmDecimationBegin(&work->decimation, level, work->held);
  EqmDecimationRun(&work->decimation, PetscMax(goal, 4), (PetscInt)PetscCeilReal(share * level->num_boundary),
                   &quality);
  PutBack(shared, k, cells, work, rest);
  return level->num_collapses;
}
