/* Products and sums of vectors: PETSc's up to rounding, the same bits for any number of threads. */
#include "support/testing.h"
#include "base/vectors.h"
#include <omp.h>

enum { COUNT = 5 };

/* Vectors with so many entries on each rank, fewer on some. */
static PetscErrorCode TestVectors(PetscInt n)
{
  PetscReal theirs[COUNT], ours[2][COUNT], norm, difference;
  const PetscReal factor[COUNT] = {.5, -2., 1e-3, 7., -.25};
  PetscMPIInt rank;
  Vec x, by_petsc, sum[2], *y;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, n / (1 + rank), PETSC_DETERMINE, &x));
  PetscCall(VecDuplicateVecs(x, COUNT, &y));
  PetscCall(VecSetRandom(x, NULL));
  for (PetscInt k = 0; k < COUNT; k++) PetscCall(VecSetRandom(y[k], NULL));
  PetscCall(VecMDot(x, COUNT, y, theirs));
  PetscCall(VecDuplicate(x, &by_petsc));
  PetscCall(VecCopy(x, by_petsc));
  PetscCall(VecMAXPY(by_petsc, COUNT, factor, y));
  for (PetscInt t = 0; t < 2; t++) {
    omp_set_num_threads(t == 0 ? 1 : 3);
    PetscCall(VecDuplicate(x, &sum[t]));
    PetscCall(VecCopy(x, sum[t]));
    PetscCall(EqmVecProducts(x, COUNT, y, ours[t]));
    PetscCall(EqmVecAddMultiples(sum[t], COUNT, factor, y));
    PetscCall(VecAXPY(by_petsc, -1., sum[t]));
    PetscCall(VecNorm(by_petsc, NORM_2, &difference));
    PetscCall(VecAXPY(by_petsc, 1., sum[t]));
    PetscCall(VecNorm(by_petsc, NORM_2, &norm));
    CHECK_CLOSE(difference, 0., 1e-13, norm + (n == 0));
  }
  omp_set_num_threads(1);
  for (PetscInt k = 0; k < COUNT; k++) {
    CHECK(ours[0][k] == ours[1][k], "product %d depends on the threads", (int)k);
    CHECK_CLOSE(ours[0][k], theirs[k], 1e-13, theirs[k] + (n == 0));
  }
  PetscCall(VecAXPY(sum[0], -1., sum[1]));
  PetscCall(VecNorm(sum[0], NORM_INFINITY, &difference));
  CHECK(difference == 0., "a sum depends on the threads");
  for (PetscInt t = 0; t < 2; t++) PetscCall(VecDestroy(&sum[t]));
  PetscCall(VecDestroyVecs(COUNT, &y));
  PetscCall(VecDestroy(&by_petsc));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestVectors(0));
  PetscCall(TestVectors(1000));
  PetscCall(TestVectors(20001));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
