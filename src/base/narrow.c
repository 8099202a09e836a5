/* Conversions to the integers of other libraries. */
#include "base/narrow.h"
#include <stdint.h>

PetscErrorCode EqmCheckFits(PetscInt64 number, size_t width, const char *library, const char *what)
{
  const PetscInt64 largest = width < sizeof(PetscInt64) ? ((PetscInt64)1 << (8 * width - 1)) - 1 : INT64_MAX;

  PetscFunctionBegin;
  PetscCheck(number >= 0 && number <= largest, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "%" PetscInt64_FMT " %s are more than the %d-bit integers of %s can count; use more ranks, "
             "-linear_solver multigrid, or a build of it with longer integers",
             number, what, (int)(8 * width), library);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGatherCounts(MPI_Comm comm, PetscInt64 mine, const char *what, PetscMPIInt *count, PetscMPIInt *start)
{
  const PetscMPIInt narrow = (PetscMPIInt)mine;
  PetscInt64 total = mine;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCall(EqmCheckFits(total, sizeof(PetscMPIInt), "MPI", what));
  PetscCallMPI(MPI_Allgather(&narrow, 1, MPI_INT, count, 1, MPI_INT, comm));
  start[0] = 0;
  for (PetscMPIInt r = 0; r < size; r++) start[r + 1] = start[r] + count[r];
  PetscFunctionReturn(0);
}
