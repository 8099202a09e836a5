/* Galerkin products of rows that are dealt to the ranks, against PETSc's. */
#include "support/testing.h"
#include "hierarchy/sharedrows.h"

/* Random blocks at random columns out of `num`, some places empty. */
static PetscErrorCode MakeRows(PetscInt num_rows, PetscInt width, PetscInt num, PetscInt seed, EqmSharedRows *rows)
{
  PetscFunctionBegin;
  PetscCall(EqmSharedRowsCreate(PETSC_COMM_WORLD, num_rows, width, rows));
  for (PetscInt q = 0; q < width * num_rows; q++) {
    const PetscInt row = rows->first + q / width, k = q % width;
    rows->column[q] = (PetscInt)(.5 * (TestRandom(seed, row, 0) + 1.) * num + 7 * k) % num;
    for (PetscInt j = 0; j < k; j++) {
      if (rows->column[q - k + j] == rows->column[q]) rows->column[q] = -1; /* each column once */
    }
    if (TestRandom(seed, row, 1 + k) < -.6) rows->column[q] = -1;
    for (int e = 0; e < 4; e++) rows->entry[q].e[e] = TestRandom(seed, row, 10 + 4 * (int)k + e);
  }
  PetscFunctionReturn(0);
}

/* So many rows and columns on each rank: none on some. */
static PetscInt Share(PetscInt num, PetscMPIInt rank, PetscMPIInt size)
{
  if (size > 2 && rank == 1) return 0;
  return num + 3 * rank;
}

static PetscErrorCode TestProduct(PetscInt seed)
{
  PetscInt num_rows, num_columns, n, m;
  PetscReal difference, norm;
  EqmSharedRows a, p, product;
  Mat mine, theirs, am, pm;
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  num_rows = Share(40, rank, size);
  num_columns = Share(11, size - 1 - rank, size);
  n = (PetscInt)TestSum(PETSC_COMM_WORLD, (PetscReal)num_rows);
  m = (PetscInt)TestSum(PETSC_COMM_WORLD, (PetscReal)num_columns);
  PetscCall(MakeRows(num_rows, 5, n, seed, &a));
  PetscCall(MakeRows(num_rows, 3, m, seed + 1, &p));
  PetscCall(EqmSharedGalerkin(PETSC_COMM_WORLD, &a, &p, num_columns, &product));
  for (PetscInt i = 0; i < product.num_rows; i++) {
    for (PetscInt q = product.start[i] + 1; q < product.start[i + 1]; q++)
      CHECK(product.column[q - 1] < product.column[q], "columns of row %d do not ascend", (int)i);
  }
  PetscCall(EqmSharedRowsMatrix(PETSC_COMM_WORLD, &a, num_rows, &am));
  PetscCall(EqmSharedRowsMatrix(PETSC_COMM_WORLD, &p, num_columns, &pm));
  PetscCall(EqmSharedRowsMatrix(PETSC_COMM_WORLD, &product, num_columns, &mine));
  PetscCall(MatPtAP(am, pm, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &theirs));
  PetscCall(MatNorm(theirs, NORM_FROBENIUS, &norm));
  PetscCall(MatAXPY(mine, -1., theirs, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatNorm(mine, NORM_FROBENIUS, &difference));
  CHECK(norm > 1., "the product is %g", (double)norm);
  CHECK_CLOSE(difference, 0., 1e-13, norm);
  PetscCall(MatDestroy(&am));
  PetscCall(MatDestroy(&pm));
  PetscCall(MatDestroy(&mine));
  PetscCall(MatDestroy(&theirs));
  PetscCall(EqmSharedRowsDestroy(&a));
  PetscCall(EqmSharedRowsDestroy(&p));
  PetscCall(EqmSharedRowsDestroy(&product));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (PetscInt seed = 0; seed < 4; seed++) PetscCall(TestProduct(10 * seed));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
