/* Solves on a tree of ranks: up with L, down with its transpose. */
#include "linalg/interface_private.h"

/* A front that is on this rank alone: L y = f, and what is left for the unknowns passed on; or, `transposed`, L^T x =
   y, given x of those. */
static PetscErrorCode SolveFront(EqmFront *front, PetscBool transposed, PetscInt num_rhs)
{
  const PetscScalar one = 1., minus_one = -1., *const below = front->panel + front->num_out;
  const char *const transpose = transposed ? "T" : "N";
  PetscScalar *const at_kept = front->columns + front->num_out;
  PetscBLASInt out, kept, rows, many;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(front->num_out, &out));
  PetscCall(PetscBLASIntCast(front->num_kept, &kept));
  PetscCall(PetscBLASIntCast(front->rows, &rows));
  PetscCall(PetscBLASIntCast(num_rhs, &many));
  if (out == 0) PetscFunctionReturn(0);
  if (transposed && kept > 0) {
    PetscCallBLAS("BLASgemm", BLASgemm_("T", "N", &out, &many, &kept, &minus_one, below, &rows, at_kept, &rows, &one,
                                        front->columns, &rows));
  }
  PetscCallBLAS("BLAStrsm",
                BLAStrsm_("L", "L", transpose, "N", &out, &many, &one, front->panel, &rows, front->columns, &rows));
  if (!transposed && kept > 0) {
    PetscCallBLAS("BLASgemm", BLASgemm_("N", "N", &kept, &many, &out, &minus_one, below, &rows, front->columns, &rows,
                                        &one, at_kept, &rows));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmInterface tree, EqmFront *front, PetscBool transposed, PetscInt num_rhs)
{
  PetscFunctionBegin;
  if (EqmFrontIsShared(front))
    PetscCall(EqmSharedFrontSolve(front, transposed, num_rhs));
  else if (EqmFrontHas(front, tree->rank))
    PetscCall(SolveFront(front, transposed, num_rhs));
  PetscFunctionReturn(0);
}

/* What a front passes on: its columns at the kept unknowns. The first front gets this rank's share. */
static EqmPassed PassedTo(EqmInterface tree, PetscInt k, PetscScalar *share)
{
  if (k == 0) return (EqmPassed){EqmGridCreate(tree->rank, 1, 0), tree->num_shared, tree->num_shared, share};
  const EqmFront *const front = &tree->front[k - 1];
  return (EqmPassed){front->grid, front->num_kept, front->rows,
                     front->columns ? front->columns + (front->rows - front->kept_rows) : NULL};
}

PetscErrorCode EqmInterfaceSolve(EqmInterface tree, PetscInt num_rhs, PetscScalar *columns)
{
  EqmPassed passed;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    EqmFront *const front = &tree->front[k];
    passed = PassedTo(tree, k, columns);
    PetscCall(PetscCalloc1((size_t)front->rows * (size_t)num_rhs, &front->columns));
    PetscCall(EqmInterfaceRaise(tree, front, num_rhs, &passed));
    PetscCall(Solve(tree, front, PETSC_FALSE, num_rhs));
  }
  for (PetscInt k = tree->num_fronts - 1; k >= 0; k--) {
    EqmFront *const front = &tree->front[k];
    passed = PassedTo(tree, k, columns);
    PetscCall(Solve(tree, front, PETSC_TRUE, num_rhs));
    PetscCall(EqmInterfaceLower(tree, front, num_rhs, &passed));
    PetscCall(PetscFree(front->columns));
  }
  PetscFunctionReturn(0);
}
