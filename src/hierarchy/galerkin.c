/* Products with a prolongation. A coarse row is one thread's work. */
#include "hierarchy/prolongation.h"
#include <stdlib.h>

enum { WIDTH = EQM_PROLONGATION_WIDTH, LEAST_ROWS = 4096 };

void EqmProlongationAdd(const EqmProlongation *p, const PetscReal *coarse, PetscReal *fine)
{
#pragma omp parallel for schedule(static) if (p->num_fine > LEAST_ROWS)
  for (PetscInt i = 0; i < p->num_fine; i++) {
    for (PetscInt q = WIDTH * i; q < WIDTH * i + WIDTH; q++) {
      if (p->column[q] >= 0) EqmBlockAddApplied(&p->entry[q], coarse + 2 * p->column[q], fine + 2 * i);
    }
  }
}

void EqmProlongationRestrict(const EqmProlongation *p, const PetscReal *fine, PetscReal *coarse)
{
#pragma omp parallel for schedule(static) if (p->num_fine > LEAST_ROWS)
  for (PetscInt j = 0; j < p->num_coarse; j++) {
    coarse[2 * j] = coarse[2 * j + 1] = 0.;
    for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
      const PetscInt q = p->from[k];
      EqmBlockAddTransposedApplied(&p->entry[q], fine + 2 * (q / WIDTH), coarse + 2 * j);
    }
  }
}

/* Columns of a coarse row, in the order in which they are met; `met` has the row's number behind each. Returns how
 * many.
 */
static PetscInt RowPattern(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, PetscInt *met,
                           PetscInt *column)
{
  PetscInt count = 0;

  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH;
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      for (PetscInt r = WIDTH * fine->column[q]; r < WIDTH * fine->column[q] + WIDTH; r++) {
        const PetscInt c = p->column[r];
        if (c < 0 || met[c] == j) continue;
        if (column) column[count] = c;
        met[c] = j;
        count++;
      }
    }
  }
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

/* How long the rows are, then where they begin. `bad`: a thread has no memory. */
static void CountRows(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse, int *bad)
{
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const met = MakeTable(p->num_columns, bad);
#pragma omp for schedule(static)
    for (PetscInt j = 0; j < p->num_coarse; j++) {
      if (met) coarse->start[j + 1] = RowPattern(p, fine, j, met, NULL);
    }
    free(met);
  }
  coarse->start[0] = 0;
  for (PetscInt j = 0; j < p->num_coarse && !*bad; j++) coarse->start[j + 1] += coarse->start[j];
}

/* A few numbers, ascending. */
static void Sort(PetscInt count, PetscInt *number)
{
  for (PetscInt k = 1; k < count; k++) {
    const PetscInt value = number[k];
    PetscInt at = k;
    for (; at > 0 && number[at - 1] > value; at--) number[at] = number[at - 1];
    number[at] = value;
  }
}

/* Columns, ascending. */
static void FindColumns(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse, int *bad)
{
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const met = MakeTable(p->num_columns, bad);
#pragma omp for schedule(static)
    for (PetscInt j = 0; j < p->num_coarse; j++) {
      PetscInt *const column = coarse->column + coarse->start[j];
      if (!met) continue;
      const PetscInt count = RowPattern(p, fine, j, met, column);
      Sort(count, column);
      for (PetscInt k = 0; k < count; k++) {
        if (column[k] == j) coarse->diagonal[j] = coarse->start[j] + k;
      }
    }
    free(met);
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
  int bad = 0;

  PetscFunctionBegin;
  *coarse = (EqmBlockMatrix){.num_rows = p->num_coarse};
  PetscCall(PetscMalloc1(p->num_coarse + 1, &coarse->start));
  PetscCall(PetscMalloc1(p->num_coarse, &coarse->diagonal));
  CountRows(p, fine, coarse, &bad);
  if (!bad) {
    PetscCall(PetscMalloc1(coarse->start[p->num_coarse], &coarse->column));
    PetscCall(PetscMalloc1(coarse->start[p->num_coarse], &coarse->mirror));
    PetscCall(PetscMalloc1(coarse->start[p->num_coarse], &coarse->entry));
    FindColumns(p, fine, coarse, &bad);
  }
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a coarser matrix");
  PetscCall(FindMirrors(coarse));
  PetscFunctionReturn(0);
}

/* A product's blocks for one fine vertex and one neighbour of it: the columns from j on. `plain`: multiples of one. */
static inline void AddProducts(const EqmProlongation *p, PetscInt j, PetscInt neighbour, const EqmBlock *half,
                               const PetscInt *place, EqmBlock *entry)
{
  for (PetscInt r = WIDTH * neighbour; r < WIDTH * neighbour + WIDTH; r++) {
    const PetscInt c = p->column[r];
    if (c < j) continue;
    if (p->plain[neighbour]) {
      for (int k = 0; k < 4; k++) entry[place[c]].e[k] += half->e[k] * p->entry[r].e[0];
    } else {
      EqmBlockAddProduct(half, &p->entry[r], &entry[place[c]]);
    }
  }
}

/* The blocks of a coarse row from the diagonal on. */
static void RowEntries(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, const PetscInt *place,
                       EqmBlock *entry)
{
  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH;
    const EqmBlock *const from = &p->entry[p->from[k]];
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      EqmBlock half = {{0., 0., 0., 0.}};
      if (p->plain[i]) {
        for (int e = 0; e < 4; e++) half.e[e] = from->e[0] * fine->entry[q].e[e];
      } else {
        EqmBlockAddTransposedProduct(from, &fine->entry[q], &half);
      }
      AddProducts(p, j, fine->column[q], &half, place, entry);
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
      for (PetscInt q = coarse->diagonal[j]; q < coarse->start[j + 1]; q++) {
        place[coarse->column[q]] = q;
        coarse->entry[q] = (EqmBlock){{0., 0., 0., 0.}};
      }
      RowEntries(p, fine, j, place, coarse->entry);
    }
    free(place);
  }
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a coarser matrix");
  FillMirrored(coarse);
  PetscFunctionReturn(0);
}
