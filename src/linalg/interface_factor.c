/* The factorisation on a tree of ranks, front by front. */
#include "linalg/interface_private.h"

/* Eliminate a front that is on this rank alone. */
static PetscErrorCode FactorFront(EqmFront *front, PetscScalar *rest, PetscBool *success)
{
  const PetscScalar one = 1., minus_one = -1.;
  PetscBLASInt out, kept, rows, info = 0;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(front->num_out, &out));
  PetscCall(PetscBLASIntCast(front->num_kept, &kept));
  PetscCall(PetscBLASIntCast(PetscMax(front->rows, 1), &rows));
  if (out > 0) PetscCallBLAS("LAPACKpotrf", LAPACKpotrf_("L", &out, front->panel, &rows, &info));
  if (info != 0) *success = PETSC_FALSE;
  if (*success && out > 0 && kept > 0) {
    PetscScalar *const below = front->panel + out;
    PetscCallBLAS("BLAStrsm", BLAStrsm_("R", "L", "T", "N", &kept, &out, &one, front->panel, &rows, below, &rows));
    PetscCallBLAS("BLASsyrk", BLASsyrk_("L", "N", &kept, &out, &minus_one, below, &rows, &one, rest, &kept));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceFactor(EqmInterface tree, PetscScalar **share, PetscBool *success)
{
  EqmPassed passed = {EqmGridCreate(tree->rank, 1, 0), tree->num_shared, tree->num_shared, *share};
  PetscBool mine = PETSC_TRUE;

  PetscFunctionBegin;
  *share = NULL;
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    EqmFront *const front = &tree->front[k];
    PetscCall(EqmInterfaceMerge(tree, front, &passed));
    if (EqmFrontIsShared(front))
      PetscCall(EqmSharedFrontFactor(front, passed.values, &mine));
    else if (EqmFrontHas(front, tree->rank))
      PetscCall(FactorFront(front, passed.values, &mine));
  }
  PetscCall(PetscFree(passed.values));
  PetscCall(MPIU_Allreduce(&mine, success, 1, MPIU_BOOL, MPI_LAND, tree->comm));
  PetscFunctionReturn(0);
}
