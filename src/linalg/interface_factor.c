/* The factorisation on a tree of ranks, front by front. */
#include "linalg/interface_private.h"
#include "base/narrow.h"

/* Entries of the lower triangle of an n x n matrix, as many as one message may carry. */
static PetscErrorCode CountTriangle(PetscInt n, PetscMPIInt *count)
{
  const PetscInt64 entries = (PetscInt64)n * (n + 1) / 2;

  PetscFunctionBegin;
  PetscCall(EqmCheckFits(entries, sizeof(PetscMPIInt), "MPI", "entries of a dense front"));
  *count = (PetscMPIInt)entries;
  PetscFunctionReturn(0);
}

/* Lower triangles travel packed, column after column. */
static PetscErrorCode SendTriangle(EqmInterface tree, PetscInt n, const PetscScalar *matrix)
{
  PetscScalar *packed, *next;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(CountTriangle(n, &count));
  PetscCall(PetscMalloc1(count, &packed));
  next = packed;
  for (PetscInt j = 0; j < n; next += n - j, j++) PetscCall(PetscArraycpy(next, matrix + (size_t)n * j + j, n - j));
  PetscCallMPI(MPI_Send(packed, count, MPIU_SCALAR, tree->parent, EQM_TAG_MATRIX, tree->comm));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReceiveTriangle(EqmInterface tree, PetscMPIInt from, PetscInt n, PetscScalar **packed)
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(CountTriangle(n, &count));
  PetscCall(PetscMalloc1(count, packed));
  PetscCallMPI(MPI_Recv(*packed, count, MPIU_SCALAR, from, EQM_TAG_MATRIX, tree->comm, MPI_STATUS_IGNORE));
  PetscFunctionReturn(0);
}

/* Add one column of a group's lower triangle, from the diagonal down, to the front. */
static void AddColumn(const EqmFront *front, const PetscInt *place, PetscInt n, PetscInt j, const PetscScalar *column,
                      PetscScalar *rest)
{
  const size_t out = (size_t)front->num_out, kept = (size_t)front->num_kept;

  for (PetscInt i = j; i < n; i++) {
    const size_t a = (size_t)PetscMax(place[i], place[j]), b = (size_t)PetscMin(place[i], place[j]);
    if (b < out)
      front->panel[b * (out + kept) + a] += column[i - j];
    else
      rest[(b - out) * kept + a - out] += column[i - j];
  }
}

/* Merge, eliminate. `share` comes as the first group's matrix and leaves as that of the unknowns passed on. */
static PetscErrorCode FactorFront(EqmInterface tree, EqmFront *front, PetscScalar **share, PetscBool *success)
{
  const PetscInt n = front->num_out + front->num_kept, first = front->num_from[0], second = front->num_from[1];
  const PetscScalar one = 1., minus_one = -1.;
  PetscScalar *rest, *packed, *next;
  PetscBLASInt out, kept, rows, info = 0;

  PetscFunctionBegin;
  if (!front->panel) PetscCall(PetscMalloc1((size_t)n * (size_t)front->num_out, &front->panel));
  PetscCall(PetscArrayzero(front->panel, (size_t)n * (size_t)front->num_out));
  PetscCall(PetscCalloc1((size_t)front->num_kept * (size_t)front->num_kept, &rest));
  for (PetscInt j = 0; j < first; j++)
    AddColumn(front, front->place[0], first, j, *share + (size_t)j * (size_t)first + j, rest);
  PetscCall(PetscFree(*share));
  PetscCall(ReceiveTriangle(tree, front->right, second, &packed));
  next = packed;
  for (PetscInt j = 0; j < second; next += second - j, j++) AddColumn(front, front->place[1], second, j, next, rest);
  PetscCall(PetscFree(packed));
  PetscCall(PetscBLASIntCast(front->num_out, &out));
  PetscCall(PetscBLASIntCast(front->num_kept, &kept));
  PetscCall(PetscBLASIntCast(PetscMax(n, 1), &rows));
  if (out > 0) PetscCallBLAS("LAPACKpotrf", LAPACKpotrf_("L", &out, front->panel, &rows, &info));
  if (info != 0) *success = PETSC_FALSE;
  if (*success && out > 0 && kept > 0) {
    PetscScalar *const below = front->panel + out;
    PetscCallBLAS("BLAStrsm", BLAStrsm_("R", "L", "T", "N", &kept, &out, &one, front->panel, &rows, below, &rows));
    PetscCallBLAS("BLASsyrk", BLASsyrk_("L", "N", &kept, &out, &minus_one, below, &rows, &one, rest, &kept));
  }
  *share = rest;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceFactor(EqmInterface tree, PetscScalar **share, PetscBool *success)
{
  PetscBool mine = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < tree->num_fronts; k++) PetscCall(FactorFront(tree, &tree->front[k], share, &mine));
  if (tree->parent >= 0) PetscCall(SendTriangle(tree, tree->num_left, *share));
  PetscCall(PetscFree(*share));
  PetscCall(MPIU_Allreduce(&mine, success, 1, MPIU_BOOL, MPI_LAND, tree->comm));
  PetscFunctionReturn(0);
}
