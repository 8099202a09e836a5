#include "problem/solenoidal_block.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"

enum { DEPTH = 128 }; /* rows that are multiplied at once */

PetscInt EqmSplineRangeColumns(const EqmSplineRange *range)
{
  return EQM_FIELDS_PER_SPLINE * range->width[0] * range->width[1] * range->width[2];
}

PetscInt EqmSplineBlockRoom(PetscInt columns)
{
  return columns * (DEPTH + 2 * columns);
}

void EqmSplineBlockBegin(const EqmSplineRange *range, PetscScalar *room, EqmSplineBlock *b)
{
  const PetscInt n = EqmSplineRangeColumns(range);

  *b = (EqmSplineBlock){
      .range = *range, .columns = n, .row = room, .product = room + n * DEPTH, .sum = room + n * (DEPTH + n)};
  for (PetscInt i = 0; i < n * n; i++) b->sum[i] = 0.;
}

void EqmSplineBlockEnd(EqmSplineBlock *b)
{
  const PetscInt n = b->columns;

  if (b->depth == 0) return;
  EqmDenseUpdate(b->row, n, n, b->depth, 0, n, b->product);
  for (PetscInt j = 0; j < n; j++) {
    for (PetscInt i = j; i < n; i++) b->sum[n * j + i] -= b->product[n * j + i];
  }
  b->depth = 0;
}

static PetscScalar *NewRow(EqmSplineBlock *b)
{
  PetscScalar *row;

  if (b->depth == DEPTH) EqmSplineBlockEnd(b);
  row = b->row + b->columns * b->depth++;
  for (PetscInt i = 0; i < b->columns; i++) row[i] = 0.;
  return row;
}

/* Add the fields at a corner against a velocity there to a row. */
EQM_CLONES static void AddCorner(const EqmSplineRange *range, const EqmSplines *s, const PetscReal *x,
                                 const PetscReal velocity[3], PetscScalar *row)
{
  const PetscInt num_splines = range->width[0] * range->width[1] * range->width[2];
  PetscReal product[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT];
  PetscInt offset[3];

  for (PetscInt k = 0; k < 3; k++) offset[k] = s->base[k] - 1 - range->begin[k];
  EqmSolenoidalAgainst(s, x, velocity, product);
  for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++) {
    for (PetscInt i = 0; i < 3; i++) {
      for (PetscInt j = 0; j < 3; j++) {
        PetscScalar *const to =
            row + f * num_splines + (range->width[1] * (offset[0] + i) + offset[1] + j) * range->width[2] + offset[2];
        for (PetscInt k = 0; k < 3; k++) to[k] += product[f][9 * i + 3 * j + k];
      }
    }
  }
}

/* The cell's Laplacian as C C^T, C with three columns: it has the constants in its null space. */
static void RootOfLaplacian(const PetscReal *weights, PetscReal root[4][3])
{
  PetscReal a[4][4];

  EqmCellLaplacian(4, weights, a);
  for (PetscInt m = 0; m < 3; m++) {
    const PetscReal pivot =
        PetscSqrtReal(PetscMax(a[m][m], PETSC_SMALL * PetscAbsReal(a[3][3]) + PETSC_MACHINE_EPSILON));
    for (PetscInt i = 0; i < 4; i++) root[i][m] = i < m ? 0. : a[i][m] / pivot;
    for (PetscInt i = m + 1; i < 4; i++) {
      for (PetscInt j = m + 1; j < 4; j++) a[i][j] -= root[i][m] * root[j][m];
    }
  }
}

void EqmSplineBlockAddVolume(EqmSplineBlock *b, const PetscReal *const p[4], const EqmSplines splines[4],
                             PetscReal factor)
{
  const PetscReal root = PetscSqrtReal(factor);
  PetscScalar *const row = NewRow(b);
  PetscReal gradient[4][3];

  EqmVolumeGradient(p, gradient[0]);
  for (PetscInt a = 0; a < 4; a++) {
    const PetscReal velocity[3] = {root * gradient[a][0], root * gradient[a][1], root * gradient[a][2]};
    AddCorner(&b->range, &splines[a], p[a], velocity, row);
  }
}

void EqmSplineBlockAddLaplacian(EqmSplineBlock *b, const PetscReal *const p[4], const EqmSplines splines[4],
                                const PetscReal *weights, PetscReal factor)
{
  const PetscReal part = PetscSqrtReal(factor);
  PetscReal root[4][3];

  RootOfLaplacian(weights, root);
  for (PetscInt k = 0; k < 3; k++) {
    for (PetscInt m = 0; m < 3; m++) {
      PetscScalar *const row = NewRow(b);
      for (PetscInt a = m; a < 4; a++) {
        PetscReal velocity[3] = {0., 0., 0.};
        velocity[k] = part * root[a][m];
        AddCorner(&b->range, &splines[a], p[a], velocity, row);
      }
    }
  }
}
