#include "hierarchy/blockmatrix.h"

/* Fewer rows are not worth the threads. */
enum { LEAST_ROWS = 4096 };

PetscErrorCode EqmBlockMatrixReset(EqmBlockMatrix *matrix)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(matrix->start));
  PetscCall(PetscFree(matrix->column));
  PetscCall(PetscFree(matrix->diagonal));
  PetscCall(PetscFree(matrix->entry));
  PetscCall(PetscFree(matrix->mirror));
  PetscFunctionReturn(0);
}

void EqmBlockMatrixMultiply(const EqmBlockMatrix *a, const PetscReal *x, PetscReal *y)
{
#pragma omp parallel for schedule(static) if (a->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < a->num_rows; i++) {
    EqmBlockSum sum = {{{0., 0.}, {0., 0.}}};
    for (PetscInt q = a->start[i]; q < a->start[i + 1]; q++) EqmBlockSumAdd(&sum, &a->entry[q], x + 2 * a->column[q]);
    y[2 * i] = sum.row[0][0] + sum.row[0][1];
    y[2 * i + 1] = sum.row[1][0] + sum.row[1][1];
  }
}

PetscErrorCode EqmBlockMatrixCompleteDiagonal(EqmBlockMatrix *a, PetscBool *success)
{
  int bad = 0;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static) reduction(| : bad) if (a->num_rows > LEAST_ROWS)
  for (PetscInt i = 0; i < a->num_rows; i++) {
    PetscReal *const d = a->entry[a->diagonal[i]].e;
    if (d[0] == 0. && d[1] == 0.) d[0] = 1.;
    if (d[3] == 0. && d[1] == 0.) d[3] = 1.;
    bad |= !(d[0] > 0. && d[0] * d[3] - d[1] * d[2] > 0.);
  }
  *success = (PetscBool)!bad;
  PetscFunctionReturn(0);
}

/* As scalar rows with ascending columns. */
static PetscErrorCode MakeScalarRows(const EqmBlockMatrix *a, EqmBlockFactor *factor)
{
  const PetscInt n = a->num_rows;
  PetscInt most = 0, at = 0, *column, *place;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) most = PetscMax(most, a->start[i + 1] - a->start[i]);
  PetscCall(PetscMalloc2(most, &column, most, &place));
  PetscCall(PetscMalloc1(2 * n + 1, &factor->row));
  PetscCall(PetscMalloc1(4 * a->start[n], &factor->column));
  PetscCall(PetscMalloc1(4 * a->start[n], &factor->place));
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
      factor->place[at++] = 4 * place[k / 2] + 2 * (r % 2) + k % 2;
    }
  }
  factor->row[2 * n] = at;
  PetscCall(PetscFree2(column, place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorCreate(const EqmBlockMatrix *a, EqmBlockFactor *factor)
{
  const PetscInt n = 2 * a->num_rows;
  PC pc;

  PetscFunctionBegin;
  PetscCall(MakeScalarRows(a, factor));
  PetscCall(
      MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, factor->row, factor->column, factor->value, &factor->matrix));
  PetscCall(MatSetOption(factor->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(KSPCreate(PETSC_COMM_SELF, &factor->ksp));
  PetscCall(KSPSetType(factor->ksp, KSPPREONLY));
  PetscCall(KSPGetPC(factor->ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatOrderingType(pc, MATORDERINGND));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorFill(const EqmBlockMatrix *a, EqmBlockFactor *factor, PetscBool *success)
{
  const PetscInt length = factor->row[2 * a->num_rows];
  PCFailedReason reason;
  PetscScalar *value;
  PC pc;

  PetscFunctionBegin;
  PetscCall(MatSeqAIJGetArray(factor->matrix, &value));
  for (PetscInt q = 0; q < length; q++) value[q] = a->entry[factor->place[q] / 4].e[factor->place[q] % 4];
  PetscCall(MatSeqAIJRestoreArray(factor->matrix, &value));
  PetscCall(KSPSetOperators(factor->ksp, factor->matrix, factor->matrix));
  PetscCall(KSPSetUp(factor->ksp));
  PetscCall(KSPGetPC(factor->ksp, &pc));
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
  PetscCall(PetscFree(factor->place));
  PetscCall(PetscFree(factor->value));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBlockFactorSolve(const EqmBlockFactor *factor, const PetscReal *b, PetscReal *x, PetscBool *success)
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
