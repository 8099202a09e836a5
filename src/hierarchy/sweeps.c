#include "hierarchy/sweeps.h"

/* Fewer rows are not worth the threads. */
enum { LEAST_ROWS = 4096 };

/* Which part of row i column j belongs to: 0, 1 or 2; the diagonal to none. The row's piece is begin .. end - 1. */
static inline int PartOf(PetscInt i, PetscInt j, PetscInt begin, PetscInt end)
{
  if (i == j) return -1;
  if (j < begin || j >= end) return 2;
  return j > i;
}

static void SortRow(const EqmBlockMatrix *a, PetscInt i, PetscInt begin, PetscInt end, EqmSweeps *s)
{
  PetscInt at = a->start[i] - i;

  for (int part = 0; part < 3; part++) {
    s->part[3 * i + part] = at;
    for (PetscInt q = a->start[i]; q < a->start[i + 1]; q++) {
      if (PartOf(i, a->column[q], begin, end) != part) continue;
      s->column[at] = a->column[q];
      s->place[at++] = q;
    }
  }
}

PetscErrorCode EqmSweepsCreate(const EqmBlockMatrix *a, PetscInt num_pieces, const PetscInt *piece_start, EqmSweeps *s)
{
  const PetscInt n = a->num_rows, length = a->start[n] - n;

  PetscFunctionBegin;
  *s = (EqmSweeps){.num_rows = n, .num_pieces = num_pieces};
  PetscCall(PetscMalloc1(num_pieces + 1, &s->piece_start));
  PetscCall(PetscArraycpy(s->piece_start, piece_start, num_pieces + 1));
  PetscCall(PetscMalloc1(3 * n + 1, &s->part));
  PetscCall(PetscMalloc1(length, &s->column));
  PetscCall(PetscMalloc1(length, &s->place));
  PetscCall(PetscMalloc1(length, &s->entry));
  PetscCall(PetscMalloc1(n, &s->diagonal));
  PetscCall(PetscMalloc1(n, &s->inverse));
#pragma omp parallel for schedule(dynamic) if (n > LEAST_ROWS)
  for (PetscInt k = 0; k < num_pieces; k++) {
    for (PetscInt i = piece_start[k]; i < piece_start[k + 1]; i++) SortRow(a, i, piece_start[k], piece_start[k + 1], s);
  }
  s->part[3 * n] = length;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSweepsCreateEven(const EqmBlockMatrix *a, EqmSweeps *s)
{
  enum { ROWS_OF_PIECE = 8192 };
  const PetscInt count = (a->num_rows + ROWS_OF_PIECE - 1) / ROWS_OF_PIECE;
  PetscInt *start;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count + 1, &start));
  for (PetscInt k = 0; k <= count; k++) start[k] = PetscMin(k * ROWS_OF_PIECE, a->num_rows);
  PetscCall(EqmSweepsCreate(a, count, start, s));
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSweepsDestroy(EqmSweeps *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->piece_start));
  PetscCall(PetscFree(s->part));
  PetscCall(PetscFree(s->column));
  PetscCall(PetscFree(s->place));
  PetscCall(PetscFree(s->entry));
  PetscCall(PetscFree(s->diagonal));
  PetscCall(PetscFree(s->inverse));
  PetscFunctionReturn(0);
}

void EqmSweepsFill(EqmSweeps *s, const EqmBlockMatrix *a)
{
#pragma omp parallel for schedule(static) if (s->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < s->num_rows; i++) {
    const EqmBlock *const diagonal = &a->entry[a->diagonal[i]];
    EqmBlock d = *diagonal;
    PetscReal beyond = 0., det;
    for (PetscInt q = s->part[3 * i]; q < s->part[3 * i + 3]; q++) {
      const PetscReal *const e = a->entry[s->place[q]].e;
      for (PetscInt k = 0; k < 4; k++) s->entry[q].e[k] = (float)e[k];
      if (q >= s->part[3 * i + 2]) beyond += .5 * PetscSqrtReal(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    }
    for (PetscInt k = 0; k < 4; k++) s->diagonal[i].e[k] = (float)d.e[k];
    d.e[0] += beyond;
    d.e[3] += beyond;
    det = d.e[0] * d.e[3] - d.e[1] * d.e[2];
    s->inverse[i] = (EqmBlock){{d.e[3] / det, -d.e[1] / det, -d.e[2] / det, d.e[0] / det}};
  }
}

typedef float Single4 __attribute__((vector_size(4 * sizeof(float)), aligned(sizeof(float)), may_alias));
typedef PetscReal Real4 __attribute__((vector_size(4 * sizeof(PetscReal))));

/* Add a block in single precision times x. */
static inline void AddSingle(Real4 *sum, const EqmSingleBlock *a, const PetscReal *x)
{
  *sum += __builtin_convertvector(*(const Single4 *)a->e, Real4) * (Real4){x[0], x[1], x[0], x[1]};
}

/* r = b - the entries from `begin` to `end` times x, and the diagonal's times it where there is one. */
static inline void Subtract(const EqmSweeps *s, const EqmSingleBlock *diagonal, PetscInt row, PetscInt begin,
                            PetscInt end, const PetscReal *x, const PetscReal *b, PetscReal *r)
{
  Real4 sum = {0., 0., 0., 0.};

  if (diagonal) AddSingle(&sum, diagonal, x + 2 * row);
  for (PetscInt q = begin; q < end; q++) AddSingle(&sum, &s->entry[q], x + 2 * s->column[q]);
  r[0] = b[0] - (sum[0] + sum[1]);
  r[1] = b[1] - (sum[2] + sum[3]);
}

/* Solve with the enlarged diagonal block. */
static inline void SolveRow(const EqmSweeps *s, PetscInt i, const PetscReal right[2], PetscReal x[2])
{
  const PetscReal *const e = s->inverse[i].e;

  x[0] = e[0] * right[0] + e[1] * right[1];
  x[1] = e[2] * right[0] + e[3] * right[1];
}

void EqmSweepForward(const EqmSweeps *s, const PetscReal *b, PetscReal *x, PetscReal *r)
{
#pragma omp parallel for schedule(dynamic) if (s->num_rows > LEAST_ROWS)
  for (PetscInt k = 0; k < s->num_pieces; k++) {
    for (PetscInt i = s->piece_start[k]; i < s->piece_start[k + 1]; i++) {
      Subtract(s, NULL, i, s->part[3 * i], s->part[3 * i + 1], x, b + 2 * i, r + 2 * i);
      SolveRow(s, i, r + 2 * i, x + 2 * i);
    }
  }
}

void EqmSweepResidual(const EqmSweeps *s, const PetscReal *x, PetscReal *r)
{
#pragma omp parallel for schedule(static) if (s->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < s->num_rows; i++)
    Subtract(s, &s->diagonal[i], i, s->part[3 * i + 1], s->part[3 * i + 3], x, r + 2 * i, r + 2 * i);
}

void EqmSweepBackward(const EqmSweeps *s, const PetscReal *b, PetscReal *x, PetscReal *r)
{
  const PetscInt n = s->num_rows;

/* what other pieces add, before their x changes; within a piece the present x is as good as x and its change apart */
#pragma omp parallel for schedule(static) if (n > LEAST_ROWS)
  for (PetscInt i = 0; i < n; i++)
    Subtract(s, NULL, i, s->part[3 * i + 2], s->part[3 * i + 3], x, b + 2 * i, r + 2 * i);
#pragma omp parallel for schedule(dynamic) if (n > LEAST_ROWS)
  for (PetscInt k = 0; k < s->num_pieces; k++) {
    for (PetscInt i = s->piece_start[k + 1] - 1; i >= s->piece_start[k]; i--) {
      PetscReal right[2], change[2];
      Subtract(s, &s->diagonal[i], i, s->part[3 * i], s->part[3 * i + 2], x, r + 2 * i, right);
      SolveRow(s, i, right, change);
      x[2 * i] += change[0];
      x[2 * i + 1] += change[1];
    }
  }
}
