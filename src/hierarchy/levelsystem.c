/* Linear systems on a level: the pattern, and the entries cell by cell. */
#include "hierarchy/levelsystem.h"

/* Fewer vertices are not worth the threads. */
enum { LEAST_VERTICES = 4096 };

/* The neighbours of a vertex and itself, ascending. Returns how many: 1 + twice the number of triangles at most. */
static PetscInt Neighbours(const EqmHierarchyLevel *level, const EqmCorners *corners, PetscInt v, PetscInt *neighbour)
{
  PetscInt n = 0;

  neighbour[n++] = v;
  for (PetscInt k = corners->start[v]; k < corners->start[v + 1]; k++) {
    for (PetscInt a = 0; a < 3; a++) {
      const PetscInt u = level->cells[3 * (corners->corner[k] / 3) + a];
      PetscInt at = n;
      while (at > 0 && neighbour[at - 1] > u) at--;
      if (at > 0 && neighbour[at - 1] == u) continue;
      for (PetscInt q = n++; q > at; q--) neighbour[q] = neighbour[q - 1];
      neighbour[at] = u;
    }
  }
  return n;
}

/* Where the blocks of a vertex's cells are in its row. */
static void PlaceCells(EqmLevelSystem *system, const EqmCorners *corners, PetscInt v)
{
  const PetscInt *const column = system->matrix.column, begin = system->matrix.start[v];

  for (PetscInt k = corners->start[v]; k < corners->start[v + 1]; k++) {
    const PetscInt c = corners->corner[k] / 3, a = corners->corner[k] % 3;
    for (PetscInt b = 0; b < 3; b++) {
      PetscInt place = begin;
      while (column[place] != system->level->cells[3 * c + b]) place++;
      system->offset[9 * c + 3 * a + b] = (int)(place - begin);
    }
  }
}

/* A row and its cells' places, from the neighbours. */
static void FillRow(EqmLevelSystem *system, const EqmCorners *corners, PetscInt v, const PetscInt *neighbour)
{
  EqmBlockMatrix *const matrix = &system->matrix;

  for (PetscInt q = matrix->start[v]; q < matrix->start[v + 1]; q++) {
    matrix->column[q] = neighbour[q - matrix->start[v]];
    if (matrix->column[q] == v) matrix->diagonal[v] = q;
  }
  PlaceCells(system, corners, v);
}

static PetscErrorCode MakePattern(EqmLevelSystem *system)
{
  const EqmHierarchyLevel *const level = system->level;
  const PetscInt n = level->num_vertices;
  EqmBlockMatrix *const matrix = &system->matrix;
  EqmCorners corners;
  PetscInt *loose; /* neighbours of vertex v from 2 corners.start[v] + v on */

  PetscFunctionBegin;
  matrix->num_rows = n;
  PetscCall(EqmCornersCreate(n, level->num_cells, level->cells, &corners));
  PetscCall(PetscMalloc1(6 * level->num_cells + n, &loose));
  PetscCall(PetscMalloc1(n + 1, &matrix->start));
  PetscCall(PetscMalloc1(n, &matrix->diagonal));
  matrix->start[0] = 0;
#pragma omp parallel for schedule(static) if (n > LEAST_VERTICES)
  for (PetscInt v = 0; v < n; v++)
    matrix->start[v + 1] = Neighbours(level, &corners, v, loose + 2 * corners.start[v] + v);
  for (PetscInt v = 0; v < n; v++) matrix->start[v + 1] += matrix->start[v];
  PetscCall(PetscMalloc1(matrix->start[n], &matrix->column));
#pragma omp parallel for schedule(static) if (n > LEAST_VERTICES)
  for (PetscInt v = 0; v < n; v++) FillRow(system, &corners, v, loose + 2 * corners.start[v] + v);
  PetscCall(PetscFree(loose));
  PetscCall(EqmCornersDestroy(&corners));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakePieces(EqmLevelSystem *system)
{
  const EqmHierarchyLevel *const level = system->level;
  int *piece;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(level->num_cells, &piece));
  for (PetscInt c = 0; c < level->num_cells; c++) {
    const PetscInt *const v = level->cells + 3 * c, k = v[0] / EQM_VERTICES_OF_PIECE;
    const PetscBool within = (PetscBool)(v[1] / EQM_VERTICES_OF_PIECE == k && v[2] / EQM_VERTICES_OF_PIECE == k);
    piece[c] = within ? (int)k : EQM_BETWEEN_PIECES;
  }
  PetscCall(EqmLevelPiecesCreate(level->num_vertices, level->num_cells, piece, &system->cells));
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemCreate(const EqmHierarchyLevel *level, const unsigned char *count, EqmLevelSystem *system)
{
  const PetscInt n = level->num_vertices;

  PetscFunctionBegin;
  *system = (EqmLevelSystem){.level = level};
  PetscCall(PetscMalloc1(n, &system->count));
  PetscCall(PetscArraycpy(system->count, count, n));
  PetscCall(PetscMalloc1(9 * level->num_cells, &system->offset));
  PetscCall(MakePattern(system));
  PetscCall(MakePieces(system));
  PetscCall(PetscMalloc1(system->matrix.start[n], &system->matrix.entry));
  PetscCall(PetscMalloc1(2 * n, &system->right));
  PetscCall(PetscCalloc1(2 * n, &system->solution));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemDestroy(EqmLevelSystem *system)
{
  PetscFunctionBegin;
  PetscCall(EqmBlockMatrixReset(&system->matrix));
  PetscCall(PetscFree(system->count));
  PetscCall(PetscFree(system->right));
  PetscCall(PetscFree(system->solution));
  PetscCall(PetscFree(system->offset));
  PetscCall(EqmLevelPiecesDestroy(&system->cells));
  PetscCall(EqmBlockFactorDestroy(&system->factor));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemClear(EqmLevelSystem *system)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(system->matrix.entry, system->matrix.start[system->matrix.num_rows]));
  PetscCall(PetscArrayzero(system->right, 2 * system->matrix.num_rows));
  PetscFunctionReturn(0);
}

void EqmLevelSystemAdd(EqmLevelSystem *system, PetscInt cell, const PetscReal *matrix, const PetscReal *right)
{
  const PetscInt *const v = system->level->cells + 3 * cell;
  const int *const offset = system->offset + 9 * cell;
  const PetscInt count[3] = {system->count[v[0]], system->count[v[1]], system->count[v[2]]},
                 first[3] = {0, count[0], count[0] + count[1]}, size = first[2] + count[2];

  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt k = 0; k < count[a]; k++) {
      const PetscReal *const row = matrix + size * (first[a] + k);
      system->right[2 * v[a] + k] += right[first[a] + k];
      for (PetscInt b = 0; b < 3; b++) {
        EqmBlock *const to = system->matrix.entry + system->matrix.start[v[a]] + offset[3 * a + b];
        for (PetscInt l = 0; l < count[b]; l++) to->e[2 * k + l] += row[first[b] + l];
      }
    }
  }
}

PetscErrorCode EqmLevelSystemEnd(EqmLevelSystem *system, PetscReal shift, PetscBool *success)
{
  EqmBlockMatrix *const matrix = &system->matrix;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < matrix->num_rows; v++) {
    matrix->entry[matrix->diagonal[v]].e[0] *= 1. + shift;
    matrix->entry[matrix->diagonal[v]].e[3] *= 1. + shift;
  }
  PetscCall(EqmBlockMatrixCompleteDiagonal(matrix, success));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemFactorSolve(EqmLevelSystem *system, PetscBool *success)
{
  EqmBlockFactor *const factor = &system->factor;

  PetscFunctionBegin;
  if (!factor->ksp) PetscCall(EqmBlockFactorCreate(&system->matrix, factor));
  PetscCall(EqmBlockFactorFill(&system->matrix, factor, success));
  if (*success) PetscCall(EqmBlockFactorSolve(factor, system->right, system->solution, success));
  PetscFunctionReturn(0);
}
