/* Lists of findings: how many, and the first few in input numbering whatever the number of ranks. */
#include "mesh/diagnose.h"

static int CompareWhere(const PetscInt a[4], const PetscInt b[4])
{
  for (int k = 0; k < 4; k++) {
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  }
  return 0;
}

/* Keep the lowest few places in ascending order. */
static void InsertWhere(EqmFinding *finding, const PetscInt where[4])
{
  PetscInt place = finding->shown;

  while (place > 0 && CompareWhere(where, finding->where[place - 1]) < 0) place--;
  if (place == EQM_FINDING_SHOWN) return;
  if (finding->shown < EQM_FINDING_SHOWN) finding->shown++;
  for (PetscInt i = finding->shown - 1; i > place; i--) {
    for (int k = 0; k < 4; k++) finding->where[i][k] = finding->where[i - 1][k];
  }
  for (int k = 0; k < 4; k++) finding->where[place][k] = where[k];
}

/* Note one finding at the given input numbers (-1 where unused). Not collective; on one rank per finding. */
void EqmFindingAdd(EqmFinding *finding, PetscInt a, PetscInt b, PetscInt c, PetscInt d)
{
  const PetscInt where[4] = {a, b, c, d};

  finding->count++;
  InsertWhere(finding, where);
}

/* Join what the ranks have found; every rank gets the same. Collective. */
PetscErrorCode EqmFindingsMerge(MPI_Comm comm, PetscInt num_findings, EqmFinding *finding)
{
  const PetscMPIInt bytes = (PetscMPIInt)(num_findings * (PetscInt)sizeof(EqmFinding));
  EqmFinding *all;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size * num_findings, &all));
  PetscCallMPI(MPI_Allgather(finding, bytes, MPI_BYTE, all, bytes, MPI_BYTE, comm));
  PetscCall(PetscMemzero(finding, bytes));
  for (PetscInt k = 0; k < size * num_findings; k++) {
    EqmFinding *const joined = &finding[k % num_findings];

    joined->count += all[k].count;
    for (PetscInt i = 0; i < all[k].shown; i++) InsertWhere(joined, all[k].where[i]);
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}
