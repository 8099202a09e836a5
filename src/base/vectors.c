#include "base/vectors.h"

/* Entries that a thread takes at a time: what stays in the first cache while it meets one vector after the other. */
enum { BLOCK = 2048 };

/* Two sums side by side: a register of any processor's holds both, so that every compiler takes the same order. */
static PetscReal Product(PetscInt n, const PetscScalar *x, const PetscScalar *y)
{
  PetscReal even = 0., odd = 0.;

  for (PetscInt i = 0; i + 1 < n; i += 2) {
    even += x[i] * y[i];
    odd += x[i + 1] * y[i + 1];
  }
  if (n % 2) even += x[n - 1] * y[n - 1];
  return even + odd;
}

/* Arrays of vectors, to be read. */
static PetscErrorCode GetArrays(PetscInt count, const Vec *y, const PetscScalar ***arrays)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, arrays));
  for (PetscInt k = 0; k < count; k++) PetscCall(VecGetArrayRead(y[k], &(*arrays)[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode RestoreArrays(PetscInt count, const Vec *y, const PetscScalar ***arrays)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < count; k++) PetscCall(VecRestoreArrayRead(y[k], &(*arrays)[k]));
  PetscCall(PetscFree(*arrays));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVecProducts(Vec x, PetscInt count, const Vec *y, PetscReal *product)
{
  const PetscScalar *mine, **others;
  PetscInt n, num_blocks;
  PetscReal *part;
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(x, &n));
  num_blocks = (n + BLOCK - 1) / BLOCK;
  PetscCall(PetscMalloc1(num_blocks * count, &part));
  PetscCall(VecGetArrayRead(x, &mine));
  PetscCall(GetArrays(count, y, &others));
#pragma omp parallel for schedule(static) if (num_blocks > 1)
  for (PetscInt b = 0; b < num_blocks; b++) {
    const PetscInt begin = b * BLOCK, length = PetscMin(n - begin, (PetscInt)BLOCK);
    for (PetscInt k = 0; k < count; k++) part[b * count + k] = Product(length, mine + begin, others[k] + begin);
  }
  PetscCall(RestoreArrays(count, y, &others));
  PetscCall(VecRestoreArrayRead(x, &mine));
  for (PetscInt k = 0; k < count; k++) product[k] = 0.;
  for (PetscInt q = 0; q < num_blocks * count; q++) product[q % count] += part[q];
  PetscCall(PetscFree(part));
  PetscCall(PetscObjectGetComm((PetscObject)x, &comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, product, (PetscMPIInt)count, MPIU_REAL, MPI_SUM, comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVecAddMultiples(Vec x, PetscInt count, const PetscReal *factor, const Vec *y)
{
  const PetscScalar **others;
  PetscScalar *mine;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArray(x, &mine));
  PetscCall(GetArrays(count, y, &others));
#pragma omp parallel for schedule(static) if (n > BLOCK)
  for (PetscInt begin = 0; begin < n; begin += BLOCK) {
    for (PetscInt k = 0; k < count; k++) {
      for (PetscInt i = begin; i < PetscMin(begin + BLOCK, n); i++) mine[i] += factor[k] * others[k][i];
    }
  }
  PetscCall(RestoreArrays(count, y, &others));
  PetscCall(VecRestoreArray(x, &mine));
  PetscFunctionReturn(0);
}
