/* Products with a prolongation. A coarse row is one thread's work. */
#include "hierarchy/prolongation.h"
#include <stdlib.h>

enum { WIDTH = EQM_PROLONGATION_WIDTH, LEAST_ROWS = 4096 };

void EqmProlongationAdd(const EqmProlongation *p, const PetscReal *coarse, PetscReal *fine)
{
#pragma omp parallel for schedule(static) if (p->num_fine > LEAST_ROWS)
  for (PetscInt i = 0; i < p->num_fine; i++) {
    EqmPoint2 *const to = (EqmPoint2 *)(fine + 2 * i);
    for (PetscInt q = WIDTH * i; q < WIDTH * i + WIDTH; q++) {
      const PetscReal *const from = coarse + 2 * p->column[q];
      if (p->column[q] < 0) continue;
      if (p->plain[i])
        *to += p->weight[q] * *(const EqmPoint2 *)from;
      else
        EqmBlockAddApplied(&p->entry[q], from, fine + 2 * i);
    }
  }
}

void EqmProlongationRestrict(const EqmProlongation *p, const PetscReal *fine, PetscReal *coarse)
{
#pragma omp parallel for schedule(static) if (p->num_fine > LEAST_ROWS)
  for (PetscInt j = 0; j < p->num_coarse; j++) {
    EqmPoint2 *const to = (EqmPoint2 *)(coarse + 2 * j);
    *to = (EqmPoint2){0., 0.};
    for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
      const PetscInt q = p->from[k], i = q / WIDTH;
      if (p->plain[i])
        *to += p->weight[q] * *(const EqmPoint2 *)(fine + 2 * i);
      else
        EqmBlockAddTransposedApplied(&p->entry[q], fine + 2 * i, coarse + 2 * j);
    }
  }
}

/* Rows are found so many at a time: their columns, one row's after the other. */
enum { ROWS_OF_CHUNK = 2048 };
typedef struct {
  PetscInt length, room, *column;
} Chunk;

/* A few numbers, ascending. PETSc's sorting is for one thread where it keeps a stack of its functions. */
static void Sort(PetscInt count, PetscInt *number)
{
  for (PetscInt k = 1; k < count; k++) {
    const PetscInt value = number[k];
    PetscInt at = k;
    for (; at > 0 && number[at - 1] > value; at--) number[at] = number[at - 1];
    number[at] = value;
  }
}

/* The columns of a coarse row, ascending, at the chunk's end; `met` has the row's number behind each. Returns how many;
   -1: no memory. */
static PetscInt FindRow(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, PetscInt *met, Chunk *chunk)
{
  PetscInt count = 0;

  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH, most = WIDTH * (fine->start[i + 1] - fine->start[i]);
    if (chunk->length + count + most > chunk->room) {
      const PetscInt room = 2 * (chunk->length + count + most);
      PetscInt *const column = realloc(chunk->column, (size_t)room * sizeof(PetscInt));
      if (!column) return -1;
      chunk->column = column;
      chunk->room = room;
    }
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      for (PetscInt r = WIDTH * fine->column[q]; r < WIDTH * fine->column[q] + WIDTH; r++) {
        const PetscInt c = p->column[r];
        if (c < 0 || met[c] == j) continue;
        met[c] = j;
        chunk->column[chunk->length + count++] = c;
      }
    }
  }
  if (count > 0) Sort(count, chunk->column + chunk->length);
  chunk->length += count;
  return count;
}

/* A thread's table of coarse columns, none of which is met or has a place yet. NULL, and `bad`, where there is no
   memory. */
static PetscInt *MakeTable(PetscInt num_columns, int *bad)
{
  PetscInt *const table = malloc((size_t)num_columns * sizeof(PetscInt));

  if (!table) {
#pragma omp atomic write
    *bad = 1;
  }
  for (PetscInt j = 0; table && j < num_columns; j++) table[j] = -1;
  return table;
}

/* All rows in chunks, how long each is at coarse->start[j + 1]. `bad`: a thread has no memory. */
static void FindChunks(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt num_chunks, Chunk *chunk,
                       EqmBlockMatrix *coarse, int *bad)
{
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const met = MakeTable(p->num_columns, bad);
#pragma omp for schedule(static)
    for (PetscInt k = 0; k < num_chunks; k++) {
      const PetscInt end = PetscMin((k + 1) * ROWS_OF_CHUNK, p->num_coarse);
      for (PetscInt j = k * ROWS_OF_CHUNK; met && j < end; j++) {
        coarse->start[j + 1] = FindRow(p, fine, j, met, &chunk[k]);
        if (coarse->start[j + 1] >= 0) continue;
#pragma omp atomic write
        *bad = 1;
        break;
      }
    }
    free(met);
  }
}

/* The chunks' columns one after the other, and where the diagonals are. */
static void JoinChunks(PetscInt num_chunks, const Chunk *chunk, EqmBlockMatrix *coarse)
{
#pragma omp parallel for schedule(static) if (coarse->num_rows > LEAST_ROWS)
  for (PetscInt k = 0; k < num_chunks; k++) {
    const PetscInt begin = k * ROWS_OF_CHUNK, end = PetscMin(begin + ROWS_OF_CHUNK, coarse->num_rows);
    for (PetscInt q = 0; q < chunk[k].length; q++) coarse->column[coarse->start[begin] + q] = chunk[k].column[q];
    for (PetscInt j = begin; j < end; j++) {
      for (PetscInt q = coarse->start[j]; q < coarse->start[j + 1]; q++) {
        if (coarse->column[q] == j) coarse->diagonal[j] = q;
      }
    }
  }
}

/* Where the transposes of the blocks before the diagonal are: as rows follow each other, so do they in the rows that
   they are mirrored to. */
static PetscErrorCode FindMirrors(EqmBlockMatrix *coarse)
{
  PetscInt *next;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(coarse->num_rows, &next));
  PetscCall(PetscArraycpy(next, coarse->start, coarse->num_rows));
  for (PetscInt j = 0; j < coarse->num_rows; j++) {
    for (PetscInt q = coarse->diagonal[j] + 1; q < coarse->start[j + 1] && coarse->column[q] < coarse->num_rows; q++)
      coarse->mirror[next[coarse->column[q]]++] = q;
  }
  PetscCall(PetscFree(next));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmProlongationGalerkinPattern(const EqmProlongation *p, const EqmBlockMatrix *fine,
                                              EqmBlockMatrix *coarse)
{
  const PetscInt n = p->num_coarse, num_chunks = (n + ROWS_OF_CHUNK - 1) / ROWS_OF_CHUNK;
  Chunk *chunk;
  int bad = 0;

  PetscFunctionBegin;
  *coarse = (EqmBlockMatrix){.num_rows = n};
  PetscCall(PetscMalloc1(n + 1, &coarse->start));
  PetscCall(PetscMalloc1(n, &coarse->diagonal));
  PetscCall(PetscCalloc1(num_chunks, &chunk));
  FindChunks(p, fine, num_chunks, chunk, coarse, &bad);
  if (!bad) {
    coarse->start[0] = 0;
    for (PetscInt j = 0; j < n; j++) coarse->start[j + 1] += coarse->start[j];
    PetscCall(PetscMalloc1(coarse->start[n], &coarse->column));
    PetscCall(PetscMalloc1(coarse->start[n], &coarse->mirror));
    PetscCall(PetscMalloc1(coarse->start[n], &coarse->entry));
    JoinChunks(num_chunks, chunk, coarse);
  }
  for (PetscInt k = 0; k < num_chunks; k++) free(chunk[k].column);
  PetscCall(PetscFree(chunk));
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a coarser matrix");
  PetscCall(FindMirrors(coarse));
  PetscFunctionReturn(0);
}

/* A product's blocks for one fine vertex and one neighbour of it. */
static inline void AddProducts(const EqmProlongation *p, PetscInt neighbour, const EqmBlock *half,
                               const PetscInt *place, EqmBlock *row)
{
  for (PetscInt r = WIDTH * neighbour; r < WIDTH * neighbour + WIDTH && p->column[r] >= 0; r++) {
    EqmBlock *const entry = &row[place[p->column[r]]];
    if (p->plain[neighbour]) {
      EqmPoint2 *const to = (EqmPoint2 *)entry->e;
      const EqmPoint2 *const from = (const EqmPoint2 *)half->e;
      to[0] += from[0] * p->weight[r];
      to[1] += from[1] * p->weight[r];
    } else {
      EqmBlockAddProduct(half, &p->entry[r], entry);
    }
  }
}

/* The blocks of a coarse row, those before the diagonal, too: to leave these out is a jump that no processor guesses,
   and takes longer. */
static void RowEntries(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, const PetscInt *place,
                       EqmBlock *row)
{
  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH;
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      EqmBlock half = {{0., 0., 0., 0.}};
      if (p->plain[i]) {
        for (int e = 0; e < 4; e++) half.e[e] = p->weight[p->from[k]] * fine->entry[q].e[e];
      } else {
        EqmBlockAddTransposedProduct(&p->entry[p->from[k]], &fine->entry[q], &half);
      }
      AddProducts(p, fine->column[q], &half, place, row);
    }
  }
}

/* The blocks before the diagonals. */
static void FillMirrored(EqmBlockMatrix *coarse)
{
#pragma omp parallel for schedule(static) if (coarse->num_rows > LEAST_ROWS)
  for (PetscInt j = 0; j < coarse->num_rows; j++) {
    for (PetscInt q = coarse->start[j]; q < coarse->diagonal[j]; q++) {
      const PetscReal *const e = coarse->entry[coarse->mirror[q]].e;
      coarse->entry[q] = (EqmBlock){{e[0], e[2], e[1], e[3]}};
    }
  }
}

PetscErrorCode EqmProlongationGalerkinFill(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse)
{
  int bad = 0;

  PetscFunctionBegin;
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const place = MakeTable(p->num_columns, &bad);
#pragma omp for schedule(static)
    for (PetscInt j = 0; j < p->num_coarse; j++) {
      if (!place) continue;
      for (PetscInt q = coarse->start[j]; q < coarse->start[j + 1]; q++) {
        place[coarse->column[q]] = q - coarse->start[j];
        coarse->entry[q] = (EqmBlock){{0., 0., 0., 0.}};
      }
      RowEntries(p, fine, j, place, coarse->entry + coarse->start[j]);
    }
    free(place);
  }
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a coarser matrix");
  FillMirrored(coarse);
  PetscFunctionReturn(0);
}
