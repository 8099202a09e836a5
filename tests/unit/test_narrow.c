/* Counts for MPI: those of all ranks in a row; too many together are refused on every rank alike, as are numbers that
   do not fit the integers of another library. */
#include "support/testing.h"
#include "base/narrow.h"

static PetscErrorCode TestCounts(PetscMPIInt rank, PetscMPIInt size)
{
  PetscMPIInt *count, *start, sum = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(size, &count, size + 1, &start));
  PetscCall(EqmGatherCounts(PETSC_COMM_WORLD, 5 + 3 * rank, "records", count, start));
  for (PetscMPIInt r = 0; r < size; r++) {
    CHECK(count[r] == 5 + 3 * r && start[r] == sum, "rank %d: %d from %d", r, count[r], start[r]);
    sum += count[r];
  }
  CHECK(start[size] == sum, "%d in all", start[size]);
  /* Each rank's are few enough, all together are one too many. */
  PetscInt64 mine = PETSC_MPI_INT_MAX / size;
  if (rank == 0) mine = (PetscInt64)PETSC_MPI_INT_MAX + 1 - (size - 1) * mine;
  CHECK_FAILS(PETSC_ERR_SUP, EqmGatherCounts(PETSC_COMM_WORLD, mine, "records", count, start));
  PetscCall(EqmGatherCounts(PETSC_COMM_WORLD, mine - (rank == 0), "records", count, start));
  CHECK(start[size] == PETSC_MPI_INT_MAX, "%d in all", start[size]);
  PetscCall(PetscFree2(count, start));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscMPIInt rank, size;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(TestCounts(rank, size));
  PetscCall(EqmCheckFits(INT32_MAX, 4, "a library", "things"));
  PetscCall(EqmCheckFits(INT64_MAX, 8, "a library", "things"));
  CHECK_FAILS(PETSC_ERR_SUP, EqmCheckFits((PetscInt64)INT32_MAX + 1, 4, "a library", "things"));
  CHECK_FAILS(PETSC_ERR_SUP, EqmCheckFits(-1, 4, "a library", "things"));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
