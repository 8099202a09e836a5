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

/* Columns of a coarse row, in the order in which they are met; `place` has their places from `base` on, or less where
   there is none yet. Returns how many. */
static PetscInt RowPattern(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, PetscInt base,
                           PetscInt *place, PetscInt *column)
{
  PetscInt count = 0;

  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH;
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      for (PetscInt r = WIDTH * fine->column[q]; r < WIDTH * fine->column[q] + WIDTH; r++) {
        const PetscInt c = p->column[r];
        if (c < 0 || place[c] >= base) continue;
        if (column) column[count] = c;
        place[c] = base + count++;
      }
    }
  }
  return count;
}

/* Its blocks, where the columns have their places. */
static void RowEntries(const EqmProlongation *p, const EqmBlockMatrix *fine, PetscInt j, const PetscInt *place,
                       EqmBlock *entry)
{
  for (PetscInt k = p->start[j]; k < p->start[j + 1]; k++) {
    const PetscInt i = p->from[k] / WIDTH;
    for (PetscInt q = fine->start[i]; q < fine->start[i + 1]; q++) {
      EqmBlock half = {{0., 0., 0., 0.}};
      EqmBlockAddTransposedProduct(&p->entry[p->from[k]], &fine->entry[q], &half);
      for (PetscInt r = WIDTH * fine->column[q]; r < WIDTH * fine->column[q] + WIDTH; r++) {
        if (p->column[r] >= 0) EqmBlockAddProduct(&half, &p->entry[r], &entry[place[p->column[r]]]);
      }
    }
  }
}

/* A thread's table for RowPattern: no column has a place. NULL, and `bad`, where there is no memory. */
static PetscInt *MakePlaces(PetscInt num_coarse, int *bad)
{
  PetscInt *const place = malloc((size_t)num_coarse * sizeof(PetscInt));

  if (!place) {
#pragma omp atomic write
    *bad = 1;
  }
  for (PetscInt j = 0; place && j < num_coarse; j++) place[j] = -1;
  return place;
}

/* How long the rows are, then where they begin. `bad`: a thread has no memory. */
static void CountRows(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse, int *bad)
{
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const place = MakePlaces(p->num_coarse, bad);
    PetscInt base = 0;
#pragma omp for schedule(static)
    for (PetscInt j = 0; j < p->num_coarse; j++) {
      if (!place) continue;
      const PetscInt count = RowPattern(p, fine, j, base, place, NULL);
      coarse->start[j + 1] = count;
      base += count;
    }
    free(place);
  }
  coarse->start[0] = 0;
  for (PetscInt j = 0; j < p->num_coarse && !*bad; j++) coarse->start[j + 1] += coarse->start[j];
}

static void FillRows(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse, int *bad)
{
#pragma omp parallel if (p->num_fine > LEAST_ROWS)
  {
    PetscInt *const place = MakePlaces(p->num_coarse, bad);
#pragma omp for schedule(static)
    for (PetscInt j = 0; j < p->num_coarse; j++) {
      const PetscInt begin = coarse->start[j];
      if (!place) continue;
      RowPattern(p, fine, j, begin, place, coarse->column + begin);
      for (PetscInt q = begin; q < coarse->start[j + 1]; q++) coarse->entry[q] = (EqmBlock){{0., 0., 0., 0.}};
      RowEntries(p, fine, j, place, coarse->entry);
      coarse->diagonal[j] = place[j];
    }
    free(place);
  }
}

PetscErrorCode EqmProlongationGalerkin(const EqmProlongation *p, const EqmBlockMatrix *fine, EqmBlockMatrix *coarse)
{
  int bad = 0;

  PetscFunctionBegin;
  *coarse = (EqmBlockMatrix){.num_rows = p->num_coarse};
  PetscCall(PetscMalloc1(p->num_coarse + 1, &coarse->start));
  PetscCall(PetscMalloc1(p->num_coarse, &coarse->diagonal));
  CountRows(p, fine, coarse, &bad);
  if (!bad) {
    PetscCall(PetscMalloc1(coarse->start[p->num_coarse], &coarse->column));
    PetscCall(PetscMalloc1(coarse->start[p->num_coarse], &coarse->entry));
    FillRows(p, fine, coarse, &bad);
  }
  PetscCheck(!bad, PETSC_COMM_SELF, PETSC_ERR_MEM, "too little memory for a coarser matrix");
  PetscFunctionReturn(0);
}
