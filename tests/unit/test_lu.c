/* LU of matrices that are not symmetric: on one rank and on all, with new values, the same solution. */
#include "support/testing.h"
#include "linalg/linalg.h"

enum { ROWS = 200 };

/* Row i: -1 - i / ROWS at i - 1, `diagonal` at i, -1.5 at i + 1 and -.5 at the row opposite. */
static PetscErrorCode Fill(Mat matrix, PetscReal diagonal)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(matrix, &begin, &end));
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt column[4] = {i, i > 0 ? i - 1 : -1, i + 1 < ROWS ? i + 1 : -1, (i + ROWS / 2) % ROWS};
    const PetscScalar value[4] = {diagonal, -1. - (PetscReal)i / ROWS, -1.5, -.5};
    PetscCall(MatSetValues(matrix, 1, &i, 4, column, value, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckSolve(Mat matrix, EqmLu lu, Vec b, Vec x, Vec r)
{
  PetscReal residual, size;

  PetscFunctionBegin;
  PetscCall(VecSet(x, 0.));
  PetscCall(EqmLuSolve(lu, b, x));
  PetscCall(MatMult(matrix, x, r));
  PetscCall(VecAXPY(r, -1., b));
  PetscCall(VecNorm(r, NORM_INFINITY, &residual));
  PetscCall(VecNorm(b, NORM_INFINITY, &size));
  CHECK_CLOSE(residual, 0., 1e-13, size);
  PetscFunctionReturn(0);
}

/* `option`: up to how many rows one rank takes the system. */
static PetscErrorCode TestLu(const char *option)
{
  PetscInt begin, end;
  PetscOptions options;
  Mat matrix;
  Vec b, x, r;
  EqmLu lu;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(option, &options));
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, ROWS, ROWS, 4, NULL, 4, NULL, &matrix));
  PetscCall(Fill(matrix, 5.));
  PetscCall(MatCreateVecs(matrix, &x, &b));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecGetOwnershipRange(b, &begin, &end));
  for (PetscInt i = begin; i < end; i++) PetscCall(VecSetValue(b, i, TestRandom(3, i, 0), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscCall(EqmLuCreate(matrix, "test_", &lu));
  PetscCall(CheckSolve(matrix, lu, b, x, r));
  PetscCall(Fill(matrix, 7.));
  PetscCall(EqmLuRefresh(lu));
  PetscCall(CheckSolve(matrix, lu, b, x, r));
  PetscCall(CheckSolve(matrix, lu, x, b, r));
  PetscCall(EqmLuDestroy(&lu));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscCall(MatDestroy(&matrix));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestLu("-linear_gather 1000"));
  PetscCall(TestLu("-linear_gather 0"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
