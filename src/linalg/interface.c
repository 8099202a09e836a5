/* The tree of ranks of a dense multifrontal Cholesky, and which unknowns are where (I. S. Duff, J. K. Reid: The
   multifrontal solution of indefinite sparse symmetric linear equations, ACM TOMS 9, 1983), with the tree and thereby
   every sum fixed in advance. */
#include "linalg/interface_private.h"
#include "base/narrow.h"

enum { MOST_LEVELS = 32 };

/* The fronts that this rank leads, and the rank that gets its update matrix. */
static PetscErrorCode FindPlace(EqmInterface tree)
{
  PetscMPIInt rank, size, low = 0, high;
  EqmFront path[MOST_LEVELS];
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(tree->comm, &rank));
  PetscCallMPI(MPI_Comm_size(tree->comm, &size));
  tree->parent = -1;
  for (high = size; high - low > 1;) {
    const PetscMPIInt middle = low + (high - low) / 2;
    if (low == rank) path[count++] = (EqmFront){.low = low, .high = high, .right = middle};
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

/* Unknowns with the ranks that have them: number, lowest, highest. */
enum { RECORD = 3 };

static int CompareRecords(const void *a, const void *b)
{
  const PetscInt *const p = a, *const q = b;
  return (*p > *q) - (*p < *q);
}

/* Put the records of both groups together, sorted, each once; those that go out here first. */
static PetscErrorCode MergeRecords(EqmFront *front, PetscInt *const record[2], PetscInt **merged)
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
static PetscErrorCode FindPlaces(EqmFront *front, int group, const PetscInt *record, const PetscInt *merged)
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
static PetscErrorCode SetUpFront(EqmInterface tree, EqmFront *front, PetscInt **record, PetscInt num_records)
{
  PetscInt *both[2] = {*record, NULL}, *merged;

  PetscFunctionBegin;
  front->num_from[0] = num_records;
  PetscCallMPI(MPI_Recv(&front->num_from[1], 1, MPIU_INT, front->right, EQM_TAG_SHAPE, tree->comm, MPI_STATUS_IGNORE));
  PetscCall(EqmCheckFits((PetscInt64)RECORD * front->num_from[1], sizeof(PetscMPIInt), "MPI", "numbers of a front"));
  PetscCall(PetscMalloc1(RECORD * front->num_from[1], &both[1]));
  PetscCallMPI(MPI_Recv(both[1], (PetscMPIInt)(RECORD * front->num_from[1]), MPIU_INT, front->right, EQM_TAG_SHAPE,
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
  PetscCall(EqmCheckFits((PetscInt64)RECORD * left, sizeof(PetscMPIInt), "MPI", "numbers of a front"));
  if (tree->parent >= 0) {
    PetscCallMPI(MPI_Send(&left, 1, MPIU_INT, tree->parent, EQM_TAG_SHAPE, comm));
    PetscCallMPI(MPI_Send(record, (PetscMPIInt)(RECORD * left), MPIU_INT, tree->parent, EQM_TAG_SHAPE, comm));
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
    EqmFront *const front = &(*tree)->front[k];
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
    const EqmFront *const front = &tree->front[k];
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
