#include "base/lookup.h"
#include <unistd.h>

PetscErrorCode EqmFileIsThere(MPI_Comm comm, const char *file, PetscBool *there)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  *there = (PetscBool)(rank == 0 && file && !access(file, F_OK));
  PetscCallMPI(MPI_Bcast(there, 1, MPIU_BOOL, 0, comm));
  PetscFunctionReturn(0);
}
