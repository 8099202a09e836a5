#include "linalg/singlesweeps.h"

enum { ROWS_OF_PIECE = 8192 };

static inline PetscInt PieceEnd(const EqmSingleSweeps *s, PetscInt k)
{
  return PetscMin(ROWS_OF_PIECE * (k + 1), s->rows->num_rows);
}

/* ---- pattern */

/* Columns of row i's piece first; both parts stay in ascending order. */
static void SortRow(EqmSingleSweeps *s, PetscInt i, PetscInt begin, PetscInt end, PetscInt *scratch)
{
  EqmSingleRows *const rows = s->rows;
  PetscInt at = rows->start[i], num_beyond = 0;

  for (PetscInt q = rows->start[i]; q < rows->start[i + 1]; q++) {
    const PetscInt column = rows->column[q];
    if (column == i) s->diagonal[i] = at;
    if (column >= begin && column < end)
      rows->column[at++] = column;
    else
      scratch[num_beyond++] = column;
  }
  s->beyond[i] = at;
  for (PetscInt k = 0; k < num_beyond; k++) rows->column[at + k] = scratch[k];
}

/* Which piece each column is of, counted over all ranks. */
static PetscErrorCode NumberPieces(const EqmSingleSweeps *s, float *piece)
{
  const EqmSingleRows *const rows = s->rows;
  PetscInt first = 0;

  PetscFunctionBegin;
  if (rows->halo) {
    PetscCallMPI(MPI_Exscan(&s->num_pieces, &first, 1, MPIU_INT, MPI_SUM, PetscObjectComm((PetscObject)rows->halo)));
  }
  for (PetscInt i = 0; i < rows->num_rows; i++) piece[EQM_SINGLE_WIDTH * i] = (float)(first + i / ROWS_OF_PIECE);
  PetscCall(EqmSingleRowsUpdateGhosts(rows, piece));
  PetscFunctionReturn(0);
}

static PetscErrorCode FindMeetings(EqmSingleSweeps *s)
{
  const EqmSingleRows *const rows = s->rows;
  float *piece;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(EQM_SINGLE_WIDTH * (rows->num_columns + rows->num_ghosts), &piece));
  PetscCall(NumberPieces(s, piece));
  for (PetscInt i = 0; i < rows->num_rows; i++) {
    const PetscInt *const column = rows->column;
    s->meets[i] = 0;
    for (PetscInt q = s->beyond[i] + 1; q < rows->start[i + 1]; q++)
      s->meets[i] |= piece[EQM_SINGLE_WIDTH * column[q]] != piece[EQM_SINGLE_WIDTH * column[s->beyond[i]]];
  }
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleSweepsCreate(EqmSingleRows *rows, EqmSingleSweeps *s)
{
  const PetscInt n = rows->num_rows;
  PetscInt *scratch;

  PetscFunctionBegin;
  *s = (EqmSingleSweeps){.rows = rows, .num_pieces = (n + ROWS_OF_PIECE - 1) / ROWS_OF_PIECE};
  PetscCall(PetscMalloc1(n, &s->diagonal));
  PetscCall(PetscMalloc1(n, &s->beyond));
  PetscCall(PetscMalloc1(n, &s->meets));
  PetscCall(PetscMalloc1(n, &s->added));
  PetscCall(PetscCalloc1((size_t)EQM_SINGLE_BLOCK * (size_t)n + 3, &s->inverse));
  PetscCall(PetscMalloc1(rows->num_columns + rows->num_ghosts, &scratch));
  for (PetscInt k = 0; k < s->num_pieces; k++) {
    for (PetscInt i = ROWS_OF_PIECE * k; i < PieceEnd(s, k); i++)
      SortRow(s, i, ROWS_OF_PIECE * k, PieceEnd(s, k), scratch);
  }
  PetscCall(PetscFree(scratch));
  PetscCall(FindMeetings(s));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleSweepsDestroy(EqmSingleSweeps *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->diagonal));
  PetscCall(PetscFree(s->beyond));
  PetscCall(PetscFree(s->meets));
  PetscCall(PetscFree(s->added));
  PetscCall(PetscFree(s->inverse));
  PetscFunctionReturn(0);
}

/* ---- diagonal blocks */

/* Of a symmetric semidefinite block; unknowns that depend on those before, as aggregates have that are too small for
   all fields, are left out: L^-T E^-1 L^-1 with zeros in E^-1. */
static void Invert(PetscReal a[3][3], float *inverse)
{
  const PetscReal least = 1e-12 * PetscMax(a[0][0], PetscMax(a[1][1], a[2][2]));
  PetscReal root[3][3] = {{1., 0., 0.}, {0., 1., 0.}, {0., 0., 1.}}, weight[3]; /* L^-1, E^-1 */

  for (int k = 0; k < 3; k++) {
    weight[k] = a[k][k] > least ? 1. / a[k][k] : 0.;
    for (int i = k + 1; i < 3; i++) {
      const PetscReal factor = weight[k] * a[i][k];
      for (int j = 0; j < 3; j++) {
        a[i][j] -= factor * a[k][j];
        root[i][j] -= factor * root[k][j];
      }
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      PetscReal sum = 0.;
      for (int k = 0; k < 3; k++) sum += root[k][i] * weight[k] * root[k][j];
      inverse[3 * j + i] = (float)sum;
    }
  }
}

static PetscBool FillRow(EqmSingleSweeps *s, PetscInt i)
{
  const EqmSingleRows *const rows = s->rows;
  const float *const d = rows->entry + EQM_SINGLE_BLOCK * s->diagonal[i];
  float *const inverse = s->inverse + EQM_SINGLE_BLOCK * i;
  PetscReal added = 0., a[3][3];
  PetscBool finite = PETSC_TRUE;

  for (PetscInt q = s->beyond[i]; s->meets[i] && q < rows->start[i + 1]; q++) {
    PetscReal square = 0.;
    for (int k = 0; k < EQM_SINGLE_BLOCK; k++) square += PetscSqr((PetscReal)rows->entry[EQM_SINGLE_BLOCK * q + k]);
    added += .5 * PetscSqrtReal(square);
  }
  s->added[i] = (float)added;
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 3; j++) a[k][j] = .5 * ((PetscReal)d[3 * j + k] + (PetscReal)d[3 * k + j]);
    a[k][k] += (PetscReal)s->added[i];
  }
  Invert(a, inverse);
  for (int k = 0; k < EQM_SINGLE_BLOCK; k++) {
    if (!isfinite(inverse[k])) finite = PETSC_FALSE;
  }
  return finite;
}

void EqmSingleSweepsFill(EqmSingleSweeps *s, PetscBool *finite)
{
  int bad = 0;

#pragma omp parallel for schedule(static) reduction(| : bad)
  for (PetscInt i = 0; i < s->rows->num_rows; i++) bad |= !FillRow(s, i);
  *finite = (PetscBool)!bad;
}

/* ---- sweeps */

EQM_INLINE Single4 Solve(const EqmSingleSweeps *s, PetscInt i, Single4 right)
{
  const float *const e = s->inverse + EQM_SINGLE_BLOCK * i;

  return EqmSingleLoad(e) * right[0] + EqmSingleLoad(e + 3) * right[1] + EqmSingleLoad(e + 6) * right[2];
}

/* (D + U) x = t. */
EQM_INLINE void Backward(const EqmSingleSweeps *s, PetscInt begin, PetscInt end, const float *t, float *x)
{
  for (PetscInt i = end - 1; i >= begin; i--) {
    const Single4 behind = EqmSingleProduct(s->rows, s->diagonal[i] + 1, s->beyond[i], x);
    EqmSingleStore(x + EQM_SINGLE_WIDTH * i, Solve(s, i, EqmSingleLoad(t + EQM_SINGLE_WIDTH * i) - behind));
  }
}

EQM_CLONES static void PieceBefore(const EqmSingleSweeps *s, PetscInt begin, PetscInt end, const float *b, float *x,
                                   float *t)
{
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt at = EQM_SINGLE_WIDTH * i;
    const Single4 right = EqmSingleLoad(b + at) - EqmSingleProduct(s->rows, s->rows->start[i], s->diagonal[i], x);
    EqmSingleStore(t + at, right);
    EqmSingleStore(x + at, Solve(s, i, right));
  }
  Backward(s, begin, end, t, x);
}

/* As (D + U) x = t: A x = t + L x + what leads out - what was added to D. */
EQM_CLONES static void PieceResidual(const EqmSingleSweeps *s, PetscInt begin, PetscInt end, const float *b,
                                     const float *x, const float *t, float *r)
{
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt at = EQM_SINGLE_WIDTH * i;
    const Single4 product = EqmSingleProduct(s->rows, s->rows->start[i], s->diagonal[i], x) +
                            EqmSingleProduct(s->rows, s->beyond[i], s->rows->start[i + 1], x);
    EqmSingleStore(r + at,
                   EqmSingleLoad(b + at) - EqmSingleLoad(t + at) + EqmSingleLoad(x + at) * s->added[i] - product);
  }
}

/* The sweep forward replaces x by z with (D + L)(z - x) = b - A x. Then (D + U) y = t, where t is what of b - A x + D x
   + U x does not change any more, leads to y with (D + U)(y - x) = D (z - x). */
EQM_CLONES static void PieceAfter(const EqmSingleSweeps *s, PetscInt begin, PetscInt end, const float *b,
                                  const float *old, float *x, float *t)
{
  const EqmSingleRows *const rows = s->rows;

  for (PetscInt i = begin; i < end; i++) {
    const PetscInt at = EQM_SINGLE_WIDTH * i;
    const Single4 right = EqmSingleLoad(b + at) + EqmSingleLoad(old + at) * s->added[i] -
                          EqmSingleProduct(rows, rows->start[i], s->diagonal[i], x) -
                          EqmSingleProduct(rows, s->beyond[i], rows->start[i + 1], old);
    EqmSingleStore(t + at, right);
    EqmSingleStore(x + at, Solve(s, i, right - EqmSingleProduct(rows, s->diagonal[i] + 1, s->beyond[i], old)));
  }
  Backward(s, begin, end, t, x);
}

void EqmSingleSweepBefore(const EqmSingleSweeps *s, const float *b, float *x, float *t)
{
#pragma omp parallel for schedule(dynamic) if (s->num_pieces > 1)
  for (PetscInt k = 0; k < s->num_pieces; k++) PieceBefore(s, ROWS_OF_PIECE * k, PieceEnd(s, k), b, x, t);
}

void EqmSingleSweepResidual(const EqmSingleSweeps *s, const float *b, const float *x, const float *t, float *r)
{
#pragma omp parallel for schedule(dynamic) if (s->num_pieces > 1)
  for (PetscInt k = 0; k < s->num_pieces; k++) PieceResidual(s, ROWS_OF_PIECE * k, PieceEnd(s, k), b, x, t, r);
}

void EqmSingleSweepAfter(const EqmSingleSweeps *s, const float *b, float *x, float *old, float *t)
{
  const PetscInt n = EQM_SINGLE_WIDTH * (s->rows->num_columns + s->rows->num_ghosts);

#pragma omp parallel for schedule(static) if (s->num_pieces > 1)
  for (PetscInt i = 0; i < n; i++) old[i] = x[i];
#pragma omp parallel for schedule(dynamic) if (s->num_pieces > 1)
  for (PetscInt k = 0; k < s->num_pieces; k++) PieceAfter(s, ROWS_OF_PIECE * k, PieceEnd(s, k), b, old, x, t);
}
