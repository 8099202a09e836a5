#include "hierarchy/blockmatrix.h"

/* Fewer rows are not worth the threads; a piece of a sweep has so many. */
enum { LEAST_ROWS = 4096, ROWS_OF_PIECE = 8192 };

PetscErrorCode EqmBlockMatrixReset(EqmBlockMatrix *matrix)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(matrix->start));
  PetscCall(PetscFree(matrix->column));
  PetscCall(PetscFree(matrix->diagonal));
  PetscCall(PetscFree(matrix->entry));
  PetscCall(PetscFree(matrix->inverse));
  PetscFunctionReturn(0);
}

/* One row times x, the columns begin .. end - 1 of it. */
static inline void MultiplyRow(const EqmBlockMatrix *a, PetscInt i, PetscInt begin, PetscInt end, const PetscReal *x,
                               PetscReal sum[2])
{
  sum[0] = sum[1] = 0.;
  for (PetscInt q = a->start[i]; q < a->start[i + 1]; q++) {
    const PetscInt j = a->column[q];
    if (j >= begin && j < end) EqmBlockAddApplied(&a->entry[q], x + 2 * j, sum);
  }
}

void EqmBlockMatrixMultiply(const EqmBlockMatrix *a, const PetscReal *x, PetscReal *y)
{
#pragma omp parallel for schedule(static) if (a->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < a->num_rows; i++) {
    MultiplyRow(a, i, 0, a->num_rows, x, y + 2 * i);
  }
}

void EqmBlockMatrixResidual(const EqmBlockMatrix *a, const PetscReal *b, const PetscReal *x, PetscReal *r)
{
#pragma omp parallel for schedule(static) if (a->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < a->num_rows; i++) {
    PetscReal sum[2];
    MultiplyRow(a, i, 0, a->num_rows, x, sum);
    r[2 * i] = b[2 * i] - sum[0];
    r[2 * i + 1] = b[2 * i + 1] - sum[1];
  }
}

PetscErrorCode EqmBlockMatrixInvertDiagonal(EqmBlockMatrix *a, PetscBool *success)
{
  int bad = 0;

  PetscFunctionBegin;
  if (!a->inverse) PetscCall(PetscMalloc1(a->num_rows, &a->inverse));
#pragma omp parallel for schedule(static) reduction(| : bad) if (a->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < a->num_rows; i++) {
    PetscReal *const d = a->entry[a->diagonal[i]].e;
    if (d[0] == 0. && d[1] == 0.) d[0] = 1.;
    if (d[3] == 0. && d[1] == 0.) d[3] = 1.;
    const PetscReal det = d[0] * d[3] - d[1] * d[2];
    bad |= !(d[0] > 0. && det > 0.);
    a->inverse[i] = (EqmBlock){{d[3] / det, -d[1] / det, -d[2] / det, d[0] / det}};
  }
  *success = (PetscBool)!bad;
  PetscFunctionReturn(0);
}

/* One row of a sweep: what the columns begin .. end - 1 have already goes to the right-hand side. */
static inline void SweepRow(const EqmBlockMatrix *a, PetscInt i, PetscInt begin, PetscInt end, const PetscReal *b,
                            PetscReal *x)
{
  PetscReal sum[2], right[2], value[2] = {0., 0.};

  MultiplyRow(a, i, begin, end, x, sum);
  right[0] = b[2 * i] - sum[0];
  right[1] = b[2 * i + 1] - sum[1];
  EqmBlockAddApplied(&a->inverse[i], right, value);
  x[2 * i] = value[0];
  x[2 * i + 1] = value[1];
}

void EqmBlockMatrixSweepForward(const EqmBlockMatrix *a, const PetscReal *b, PetscReal *x)
{
  const PetscInt rows = ROWS_OF_PIECE;

#pragma omp parallel for schedule(dynamic) if (a->num_rows > LEAST_ROWS)
  for (PetscInt begin = 0; begin < a->num_rows; begin += rows) {
    for (PetscInt i = begin; i < PetscMin(begin + rows, a->num_rows); i++) SweepRow(a, i, begin, i, b, x);
  }
}

void EqmBlockMatrixSweepBackward(const EqmBlockMatrix *a, const PetscReal *b, PetscReal *x)
{
  const PetscInt rows = ROWS_OF_PIECE;

#pragma omp parallel for schedule(dynamic) if (a->num_rows > LEAST_ROWS)
  for (PetscInt begin = 0; begin < a->num_rows; begin += rows) {
    const PetscInt end = PetscMin(begin + rows, a->num_rows);
    for (PetscInt i = end - 1; i >= begin; i--) SweepRow(a, i, i + 1, end, b, x);
  }
}

/* As scalar rows with ascending columns, `rank` a row's columns in order. */
static PetscErrorCode MakeScalarRows(const EqmBlockMatrix *a, EqmBlockFactor *factor)
{
  const PetscInt n = a->num_rows;
  PetscInt most = 0, at = 0, *column, *place;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) most = PetscMax(most, a->start[i + 1] - a->start[i]);
  PetscCall(PetscMalloc2(most, &column, most, &place));
  PetscCall(PetscMalloc1(2 * n + 1, &factor->row));
  PetscCall(PetscMalloc1(4 * a->start[n], &factor->column));
  PetscCall(PetscMalloc1(4 * a->start[n], &factor->value));
  for (PetscInt r = 0; r < 2 * n; r++) {
    const PetscInt i = r / 2, begin = a->start[i], count = a->start[i + 1] - begin;
    for (PetscInt k = 0; k < count; k++) {
      column[k] = a->column[begin + k];
      place[k] = begin + k;
    }
    PetscCall(PetscSortIntWithArray(count, column, place));
    factor->row[r] = at;
    for (PetscInt k = 0; k < 2 * count; k++) {
      factor->column[at] = 2 * column[k / 2] + k % 2;
      factor->value[at++] = a->entry[place[k / 2]].e[2 * (r % 2) + k % 2];
    }
  }
  factor->row[2 * n] = at;
  PetscCall(PetscFree2(column, place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorCreate(const EqmBlockMatrix *a, EqmBlockFactor *factor, PetscBool *success)
{
  const PetscInt n = 2 * a->num_rows;
  PCFailedReason reason;
  PC pc;

  PetscFunctionBegin;
  PetscCall(MakeScalarRows(a, factor));
  PetscCall(
      MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, factor->row, factor->column, factor->value, &factor->matrix));
  PetscCall(MatSetOption(factor->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(KSPCreate(PETSC_COMM_SELF, &factor->ksp));
  PetscCall(KSPSetType(factor->ksp, KSPPREONLY));
  PetscCall(KSPSetOperators(factor->ksp, factor->matrix, factor->matrix));
  PetscCall(KSPGetPC(factor->ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatOrderingType(pc, MATORDERINGND));
  PetscCall(KSPSetUp(factor->ksp));
  PetscCall(PCGetFailedReason(pc, &reason));
  *success = (PetscBool)(reason == PC_NOERROR);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorDestroy(EqmBlockFactor *factor)
{
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&factor->ksp));
  PetscCall(MatDestroy(&factor->matrix));
  PetscCall(PetscFree(factor->row));
  PetscCall(PetscFree(factor->column));
  PetscCall(PetscFree(factor->value));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorSolve(const EqmBlockFactor *factor, PetscReal *b, PetscReal *x, PetscBool *success)
{
  KSPConvergedReason reason;
  PetscInt n;
  Vec right, solution;

  PetscFunctionBegin;
  PetscCall(MatGetSize(factor->matrix, &n, NULL));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, b, &right));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, x, &solution));
  PetscCall(KSPSolve(factor->ksp, right, solution));
  PetscCall(KSPGetConvergedReason(factor->ksp, &reason));
  *success = (PetscBool)(reason > 0);
  PetscCall(VecDestroy(&right));
  PetscCall(VecDestroy(&solution));
  PetscFunctionReturn(0);
}
