/* Dense multifrontal Cholesky over a tree of ranks (I. S. Duff, J. K. Reid: The multifrontal solution of indefinite
   sparse symmetric linear equations, ACM TOMS 9, 1983), with the tree and thereby every sum fixed in advance. */
#include "linalg/interface.h"
#include <petscblaslapack.h>

enum { MOST_LEVELS = 32, TAG_SHAPE = 4101, TAG_MATRIX, TAG_UP, TAG_DOWN };

/* A merge of two groups of ranks, led by the lowest rank of the first. Its unknowns: those eliminated here, then those
   passed on. */
typedef struct {
  PetscMPIInt low, high, right; /* ranks low .. high - 1; `right` leads the second group, low the first */
  PetscInt num_out, num_kept;
  PetscInt num_from[2], *place[2]; /* where the unknowns of either group stand in this front */
  PetscScalar *panel;              /* columns of the eliminated ones: lower triangle of the factor */
  PetscScalar *columns;            /* right-hand sides during a solve */
} Front;

struct _p_EqmInterface {
  MPI_Comm comm;
  PetscMPIInt parent; /* the rank that takes what is left of the last front; -1: this is the root */
  PetscInt num_fronts, num_shared, num_left;
  Front *front; /* those that this rank leads, from the leaf to the root */
};

/* The fronts that this rank leads and the rank that it hands on to. */
static PetscErrorCode FindPlace(EqmInterface tree)
{
  PetscMPIInt rank, size, low = 0, high;
  Front path[MOST_LEVELS];
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(tree->comm, &rank));
  PetscCallMPI(MPI_Comm_size(tree->comm, &size));
  tree->parent = -1;
  for (high = size; high - low > 1;) {
    const PetscMPIInt middle = low + (high - low) / 2;
    if (low == rank) path[count++] = (Front){.low = low, .high = high, .right = middle};
    if (rank < middle) {
      high = middle;
    } else {
      tree->parent = low;
      low = middle;
    }
  }
  tree->num_fronts = count;
  PetscCall(PetscMalloc1(count, &tree->front));
  for (PetscInt k = 0; k < count; k++) tree->front[k] = path[count - 1 - k];
  PetscFunctionReturn(0);
}

/* ---- which unknowns are where */

/* Unknowns with the ranks that have them: number, lowest, highest. */
enum { RECORD = 3 };

static int CompareRecords(const void *a, const void *b)
{
  const PetscInt *const p = a, *const q = b;
  return (*p > *q) - (*p < *q);
}

/* Put the records of both groups together, sorted, each once; those that go out here first. */
static PetscErrorCode MergeRecords(Front *front, PetscInt *const record[2], PetscInt **merged)
{
  const PetscInt total = front->num_from[0] + front->num_from[1];
  PetscInt *all, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(RECORD * total, &all));
  PetscCall(PetscMalloc1(RECORD * total, merged));
  PetscCall(PetscArraycpy(all, record[0], RECORD * front->num_from[0]));
  PetscCall(PetscArraycpy(all + RECORD * front->num_from[0], record[1], RECORD * front->num_from[1]));
  qsort(all, (size_t)total, RECORD * sizeof(PetscInt), CompareRecords);
  for (int out = 1; out >= 0; out--) {
    for (PetscInt k = 0; k < total; k++) {
      const PetscInt *const r = all + RECORD * k;
      if ((r[1] >= front->low && r[2] < front->high) != out || (k > 0 && r[0] == r[-RECORD])) continue;
      PetscCall(PetscArraycpy(*merged + RECORD * count++, r, RECORD));
    }
    if (out) front->num_out = count;
  }
  front->num_kept = count - front->num_out;
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

/* Where one group's unknowns stand in the front. */
static PetscErrorCode FindPlaces(Front *front, int group, const PetscInt *record, const PetscInt *merged)
{
  const PetscInt begin[3] = {0, front->num_out, front->num_out + front->num_kept};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(front->num_from[group], &front->place[group]));
  for (PetscInt k = 0; k < front->num_from[group]; k++) {
    const PetscInt *const r = record + RECORD * k;
    const int kept = !(r[1] >= front->low && r[2] < front->high);
    const PetscInt *const found = bsearch(r, merged + RECORD * begin[kept], (size_t)(begin[kept + 1] - begin[kept]),
                                          RECORD * sizeof(PetscInt), CompareRecords);
    front->place[group][k] = (PetscInt)(found - merged) / RECORD;
  }
  PetscFunctionReturn(0);
}

/* Meet the other group and settle who stands where; `record` becomes that of the unknowns passed on. */
static PetscErrorCode SetUpFront(EqmInterface tree, Front *front, PetscInt **record, PetscInt num_records)
{
  PetscInt *both[2] = {*record, NULL}, *merged;

  PetscFunctionBegin;
  front->num_from[0] = num_records;
  PetscCallMPI(MPI_Recv(&front->num_from[1], 1, MPIU_INT, front->right, TAG_SHAPE, tree->comm, MPI_STATUS_IGNORE));
  PetscCall(PetscMalloc1(RECORD * front->num_from[1], &both[1]));
  PetscCallMPI(MPI_Recv(both[1], (PetscMPIInt)(RECORD * front->num_from[1]), MPIU_INT, front->right, TAG_SHAPE,
                        tree->comm, MPI_STATUS_IGNORE));
  PetscCall(MergeRecords(front, both, &merged));
  for (int group = 0; group < 2; group++) {
    PetscCall(FindPlaces(front, group, both[group], merged));
    PetscCall(PetscFree(both[group]));
  }
  PetscCall(PetscMalloc1(RECORD * front->num_kept, record));
  PetscCall(PetscArraycpy(*record, merged + RECORD * front->num_out, RECORD * front->num_kept));
  PetscCall(PetscFree(merged));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceCreate(MPI_Comm comm, PetscInt num_shared, const PetscInt *unknown, const PetscInt *span,
                                  EqmInterface *out)
{
  EqmInterface tree;
  PetscInt *record, left = num_shared;

  PetscFunctionBegin;
  PetscCall(PetscNew(&tree));
  tree->comm = comm;
  tree->num_shared = num_shared;
  PetscCall(FindPlace(tree));
  PetscCall(PetscMalloc1(RECORD * num_shared, &record));
  for (PetscInt k = 0; k < num_shared; k++) {
    record[RECORD * k] = unknown[k];
    record[RECORD * k + 1] = span[2 * k];
    record[RECORD * k + 2] = span[2 * k + 1];
  }
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    PetscCall(SetUpFront(tree, &tree->front[k], &record, left));
    left = tree->front[k].num_kept;
  }
  tree->num_left = left;
  if (tree->parent >= 0) {
    PetscCallMPI(MPI_Send(&left, 1, MPIU_INT, tree->parent, TAG_SHAPE, comm));
    PetscCallMPI(MPI_Send(record, (PetscMPIInt)(RECORD * left), MPIU_INT, tree->parent, TAG_SHAPE, comm));
  }
  PetscCall(PetscFree(record));
  *out = tree;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceDestroy(EqmInterface *tree)
{
  PetscFunctionBegin;
  if (!*tree) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < (*tree)->num_fronts; k++) {
    Front *const front = &(*tree)->front[k];
    PetscCall(PetscFree(front->place[0]));
    PetscCall(PetscFree(front->place[1]));
    PetscCall(PetscFree(front->panel));
    PetscCall(PetscFree(front->columns));
  }
  PetscCall(PetscFree((*tree)->front));
  PetscCall(PetscFree(*tree));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceGetCost(EqmInterface tree, PetscInt *largest, PetscReal *bytes, PetscReal *flops)
{
  PetscReal panels = 0., most = PetscSqr((PetscReal)tree->num_shared);
  PetscInt mine = tree->num_shared;

  PetscFunctionBegin;
  *flops = 0.;
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    const Front *const front = &tree->front[k];
    const PetscReal out = front->num_out, kept = front->num_kept, first = front->num_from[0],
                    second = front->num_from[1];
    panels += out * (out + kept);
    most = PetscMax(most, panels + kept * kept + PetscMax(first * first, .5 * second * second));
    mine = PetscMax(mine, front->num_out + front->num_kept);
    *flops += out * out * out / 3. + kept * out * out + kept * kept * out;
  }
  *bytes = most * (PetscReal)sizeof(PetscScalar);
  PetscCall(MPIU_Allreduce(&mine, largest, 1, MPIU_INT, MPI_MAX, tree->comm));
  PetscFunctionReturn(0);
}

/* ---- factorisation */

/* Lower triangles travel packed, column after column. */
static PetscErrorCode SendTriangle(EqmInterface tree, PetscInt n, const PetscScalar *matrix)
{
  PetscScalar *packed, *next;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(n * (n + 1) / 2, &count));
  PetscCall(PetscMalloc1(count, &packed));
  next = packed;
  for (PetscInt j = 0; j < n; next += n - j, j++) PetscCall(PetscArraycpy(next, matrix + (size_t)n * j + j, n - j));
  PetscCallMPI(MPI_Send(packed, count, MPIU_SCALAR, tree->parent, TAG_MATRIX, tree->comm));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReceiveTriangle(EqmInterface tree, PetscMPIInt from, PetscInt n, PetscScalar **packed)
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(n * (n + 1) / 2, &count));
  PetscCall(PetscMalloc1(count, packed));
  PetscCallMPI(MPI_Recv(*packed, count, MPIU_SCALAR, from, TAG_MATRIX, tree->comm, MPI_STATUS_IGNORE));
  PetscFunctionReturn(0);
}

/* Add one column of a group's lower triangle, from the diagonal down, to the front. */
static void AddColumn(const Front *front, const PetscInt *place, PetscInt n, PetscInt j, const PetscScalar *column,
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
static PetscErrorCode FactorFront(EqmInterface tree, Front *front, PetscScalar **share, PetscBool *success)
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

/* ---- solves */

/* Columns of `count` numbers each, from and to rows of a front. */
static void AddRows(const PetscInt *place, PetscInt count, PetscInt num_rhs, const PetscScalar *from, PetscInt rows,
                    PetscScalar *to)
{
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < count; k++) to[(size_t)c * rows + place[k]] += from[(size_t)c * count + k];
  }
}

static void TakeRows(const PetscInt *place, PetscInt count, PetscInt num_rhs, PetscInt rows, const PetscScalar *from,
                     PetscScalar *to)
{
  for (PetscInt c = 0; c < num_rhs; c++) {
    for (PetscInt k = 0; k < count; k++) to[(size_t)c * count + k] = from[(size_t)c * rows + place[k]];
  }
}

/* L y = f on this front; what is left for the unknowns passed on goes to `columns`. */
static PetscErrorCode SolveUp(EqmInterface tree, Front *front, PetscInt num_rhs, PetscScalar **columns)
{
  const PetscInt n = front->num_out + front->num_kept, other = front->num_from[1];
  const PetscScalar one = 1., minus_one = -1.;
  PetscScalar *received;
  PetscBLASInt out, kept, rows, many;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n * num_rhs, &front->columns));
  AddRows(front->place[0], front->num_from[0], num_rhs, *columns, n, front->columns);
  PetscCall(PetscFree(*columns));
  PetscCall(PetscMalloc1(other * num_rhs, &received));
  PetscCallMPI(MPI_Recv(received, (PetscMPIInt)(other * num_rhs), MPIU_SCALAR, front->right, TAG_UP, tree->comm,
                        MPI_STATUS_IGNORE));
  AddRows(front->place[1], other, num_rhs, received, n, front->columns);
  PetscCall(PetscFree(received));
  PetscCall(PetscBLASIntCast(front->num_out, &out));
  PetscCall(PetscBLASIntCast(front->num_kept, &kept));
  PetscCall(PetscBLASIntCast(n, &rows));
  PetscCall(PetscBLASIntCast(num_rhs, &many));
  if (out > 0) {
    PetscCallBLAS("BLAStrsm",
                  BLAStrsm_("L", "L", "N", "N", &out, &many, &one, front->panel, &rows, front->columns, &rows));
  }
  if (out > 0 && kept > 0) {
    PetscCallBLAS("BLASgemm", BLASgemm_("N", "N", &kept, &many, &out, &minus_one, front->panel + out, &rows,
                                        front->columns, &rows, &one, front->columns + out, &rows));
  }
  PetscCall(PetscMalloc1(front->num_kept * num_rhs, columns));
  for (PetscInt c = 0; c < num_rhs; c++)
    PetscCall(PetscArraycpy(*columns + c * front->num_kept, front->columns + c * n + front->num_out, front->num_kept));
  PetscFunctionReturn(0);
}

/* L^T x = y, given x of the unknowns passed on in `columns`, which leaves as x of the first group's. */
static PetscErrorCode SolveDown(EqmInterface tree, Front *front, PetscInt num_rhs, PetscScalar **columns)
{
  const PetscInt n = front->num_out + front->num_kept, other = front->num_from[1];
  const PetscScalar one = 1., minus_one = -1.;
  PetscScalar *sent;
  PetscBLASInt out, kept, rows, many;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < num_rhs; c++)
    PetscCall(PetscArraycpy(front->columns + c * n + front->num_out, *columns + c * front->num_kept, front->num_kept));
  PetscCall(PetscFree(*columns));
  PetscCall(PetscBLASIntCast(front->num_out, &out));
  PetscCall(PetscBLASIntCast(front->num_kept, &kept));
  PetscCall(PetscBLASIntCast(n, &rows));
  PetscCall(PetscBLASIntCast(num_rhs, &many));
  if (out > 0 && kept > 0) {
    PetscCallBLAS("BLASgemm", BLASgemm_("T", "N", &out, &many, &kept, &minus_one, front->panel + out, &rows,
                                        front->columns + out, &rows, &one, front->columns, &rows));
  }
  if (out > 0) {
    PetscCallBLAS("BLAStrsm",
                  BLAStrsm_("L", "L", "T", "N", &out, &many, &one, front->panel, &rows, front->columns, &rows));
  }
  PetscCall(PetscMalloc1(other * num_rhs, &sent));
  TakeRows(front->place[1], other, num_rhs, n, front->columns, sent);
  PetscCallMPI(MPI_Send(sent, (PetscMPIInt)(other * num_rhs), MPIU_SCALAR, front->right, TAG_DOWN, tree->comm));
  PetscCall(PetscFree(sent));
  PetscCall(PetscMalloc1(front->num_from[0] * num_rhs, columns));
  TakeRows(front->place[0], front->num_from[0], num_rhs, n, front->columns, *columns);
  PetscCall(PetscFree(front->columns));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceSolve(EqmInterface tree, PetscInt num_rhs, PetscScalar *columns)
{
  PetscScalar *now;
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(tree->num_shared * num_rhs, &now));
  PetscCall(PetscArraycpy(now, columns, tree->num_shared * num_rhs));
  for (PetscInt k = 0; k < tree->num_fronts; k++) PetscCall(SolveUp(tree, &tree->front[k], num_rhs, &now));
  PetscCall(PetscMPIIntCast(tree->num_left * num_rhs, &count));
  if (tree->parent >= 0) {
    PetscCallMPI(MPI_Send(now, count, MPIU_SCALAR, tree->parent, TAG_UP, tree->comm));
    PetscCallMPI(MPI_Recv(now, count, MPIU_SCALAR, tree->parent, TAG_DOWN, tree->comm, MPI_STATUS_IGNORE));
  }
  for (PetscInt k = tree->num_fronts - 1; k >= 0; k--) PetscCall(SolveDown(tree, &tree->front[k], num_rhs, &now));
  PetscCall(PetscArraycpy(columns, now, tree->num_shared * num_rhs));
  PetscCall(PetscFree(now));
  PetscFunctionReturn(0);
}
