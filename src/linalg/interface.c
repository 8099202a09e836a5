/* The tree of ranks of a dense multifrontal Cholesky, and which unknowns are where (I. S. Duff, J. K. Reid: The
   multifrontal solution of indefinite sparse symmetric linear equations, ACM TOMS 9, 1983), with the tree and thereby
   every sum fixed in advance. */
#include "linalg/interface_private.h"
#include "base/narrow.h"
#include "base/sort.h"

enum { MOST_LEVELS = 32 };

/* The merges on the way from this rank to the root. */
static PetscErrorCode FindPath(EqmInterface tree)
{
  PetscMPIInt size, low = 0, high;
  EqmFront path[MOST_LEVELS];
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(tree->comm, &tree->rank));
  PetscCallMPI(MPI_Comm_size(tree->comm, &size));
  for (high = size; high - low > 1;) {
    const PetscMPIInt middle = low + (high - low) / 2, side = tree->rank >= middle;
    path[count++] = (EqmFront){.low = low, .high = high, .right = middle, .side = side, .comm = MPI_COMM_NULL};
    if (side) {
      low = middle;
    } else {
      high = middle;
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
  EqmSort(all, (size_t)total, RECORD * sizeof(PetscInt), CompareRecords);
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
    const PetscInt *const found = EqmSearch(r, merged + RECORD * begin[kept], (size_t)(begin[kept + 1] - begin[kept]),
                                            RECORD * sizeof(PetscInt), CompareRecords);
    front->place[group][k] = (PetscInt)(found - merged) / RECORD;
  }
  PetscFunctionReturn(0);
}

/* What the leader of a group tells of it: unknowns passed on, and all those of its last front. */
typedef struct {
  PetscInt passed, size;
} Group;

/* Meet the other group and settle who stands where; `record` becomes that of the unknowns passed on. On the leader. */
static PetscErrorCode SetUpFront(EqmInterface tree, EqmFront *front, Group group[2], PetscInt **record)
{
  PetscInt *both[2] = {*record, NULL}, *merged;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Recv(&group[1], 2, MPIU_INT, front->right, EQM_TAG_SHAPE, tree->comm, MPI_STATUS_IGNORE));
  PetscCall(EqmCheckFits((PetscInt64)RECORD * group[1].passed, sizeof(PetscMPIInt), "MPI", "numbers of a front"));
  PetscCall(PetscMalloc1(RECORD * group[1].passed, &both[1]));
  PetscCallMPI(MPI_Recv(both[1], (PetscMPIInt)(RECORD * group[1].passed), MPIU_INT, front->right, EQM_TAG_SHAPE,
                        tree->comm, MPI_STATUS_IGNORE));
  for (int side = 0; side < 2; side++) front->num_from[side] = group[side].passed;
  PetscCall(MergeRecords(front, both, &merged));
  for (int side = 0; side < 2; side++) {
    PetscCall(FindPlaces(front, side, both[side], merged));
    PetscCall(PetscFree(both[side]));
  }
  PetscCall(PetscMalloc1(RECORD * front->num_kept, record));
  PetscCall(PetscArraycpy(*record, merged + RECORD * front->num_out, RECORD * front->num_kept));
  PetscCall(PetscFree(merged));
  PetscFunctionReturn(0);
}

/* Up the tree, as far as this rank leads: `group` are those that meet in each front. */
static PetscErrorCode MeetGroups(EqmInterface tree, PetscInt *record, Group (*group)[2])
{
  Group mine = {tree->num_shared, 0};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    EqmFront *const front = &tree->front[k];
    if (front->side == 1) {
      PetscCall(EqmCheckFits((PetscInt64)RECORD * mine.passed, sizeof(PetscMPIInt), "MPI", "numbers of a front"));
      PetscCallMPI(MPI_Send(&mine, 2, MPIU_INT, front->low, EQM_TAG_SHAPE, tree->comm));
      PetscCallMPI(
          MPI_Send(record, (PetscMPIInt)(RECORD * mine.passed), MPIU_INT, front->low, EQM_TAG_SHAPE, tree->comm));
      break;
    }
    group[k][0] = mine;
    PetscCall(SetUpFront(tree, front, group[k], &record));
    mine = (Group){front->num_kept, front->num_out + front->num_kept};
  }
  PetscCall(PetscFree(record));
  PetscFunctionReturn(0);
}

/* The ranks that hold a front of n unknowns. */
static EqmGrid GridOf(EqmInterface tree, PetscMPIInt low, PetscMPIInt high, PetscInt n)
{
  return EqmGridCreate(low, n > tree->shared_front ? high - low : 1, n);
}

/* Which part of a front, whose sizes are known, is on this rank. */
static PetscErrorCode SetUpParts(EqmInterface tree, EqmFront *front)
{
  const EqmGrid grid = front->grid;
  const PetscInt round = grid.block * grid.rows;

  PetscFunctionBegin;
  front->kept_begin = (front->num_out + round - 1) / round * round;
  if (!EqmFrontHas(front, tree->rank)) PetscFunctionReturn(0);
  const PetscMPIInt row = EqmGridRow(grid, tree->rank), column = EqmGridColumn(grid, tree->rank);
  front->kept_rows = EqmDealtCount(front->num_kept, grid.block, grid.rows, row);
  front->rows = front->kept_begin / grid.rows + front->kept_rows;
  front->out_columns = EqmDealtCount(front->num_out, grid.block, grid.columns, column);
  front->kept_columns = EqmDealtCount(front->num_kept, grid.block, grid.columns, column);
  PetscFunctionReturn(0);
}

/* The leader tells the others of both groups. */
static PetscErrorCode ShareShape(EqmInterface tree, EqmFront *front, const Group group[2])
{
  PetscInt shape[4] = {front->num_out, front->num_kept, group[0].size, group[1].size};
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(shape, 4, MPIU_INT, 0, front->comm));
  PetscCallMPI(MPI_Bcast(front->num_from, 2, MPIU_INT, 0, front->comm));
  front->num_out = shape[0];
  front->num_kept = shape[1];
  front->grid = GridOf(tree, front->low, front->high, front->num_out + front->num_kept);
  front->from_grid[0] = GridOf(tree, front->low, front->right, shape[2]);
  front->from_grid[1] = GridOf(tree, front->right, front->high, shape[3]);
  for (int side = 0; side < 2; side++) {
    if (!front->place[side]) PetscCall(PetscMalloc1(front->num_from[side], &front->place[side]));
    PetscCall(PetscMPIIntCast(front->num_from[side], &count));
    PetscCallMPI(MPI_Bcast(front->place[side], count, MPIU_INT, 0, front->comm));
  }
  PetscCall(SetUpParts(tree, front));
  if (EqmFrontIsShared(front)) PetscCall(EqmSharedFrontSetUp(front));
  PetscFunctionReturn(0);
}

/* Down the tree: every rank gets to know the fronts on its path. */
static PetscErrorCode ShareShapes(EqmInterface tree, Group (*group)[2])
{
  MPI_Comm comm;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_dup(tree->comm, &comm));
  for (PetscInt k = tree->num_fronts - 1; k >= 0; k--) {
    EqmFront *const front = &tree->front[k];
    front->comm = comm;
    PetscCallMPI(MPI_Comm_split(front->comm, front->side, tree->rank, &comm));
    PetscCall(ShareShape(tree, front, group[k]));
    if (!EqmFrontIsShared(front)) PetscCallMPI(MPI_Comm_free(&front->comm));
  }
  PetscCallMPI(MPI_Comm_free(&comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceCreate(MPI_Comm comm, PetscInt num_shared, const PetscInt *unknown, const PetscInt *span,
                                  PetscInt shared_front, EqmInterface *out)
{
  EqmInterface tree;
  PetscInt *record;
  Group group[MOST_LEVELS][2] = {{{0, 0}}};

  PetscFunctionBegin;
  PetscCall(PetscNew(&tree));
  tree->comm = comm;
  tree->num_shared = num_shared;
  tree->shared_front = EqmInterfaceCanShare() ? shared_front : PETSC_MAX_INT;
  PetscCall(FindPath(tree));
  PetscCall(PetscMalloc1(RECORD * num_shared, &record));
  for (PetscInt k = 0; k < num_shared; k++) {
    record[RECORD * k] = unknown[k];
    record[RECORD * k + 1] = span[2 * k];
    record[RECORD * k + 2] = span[2 * k + 1];
  }
  PetscCall(MeetGroups(tree, record, group));
  PetscCall(ShareShapes(tree, group));
  *out = tree;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmInterfaceDestroy(EqmInterface *tree)
{
  PetscFunctionBegin;
  if (!*tree) PetscFunctionReturn(0);
  for (PetscInt k = (*tree)->num_fronts - 1; k >= 0; k--) {
    EqmFront *const front = &(*tree)->front[k];
    if (EqmFrontIsShared(front)) PetscCall(EqmSharedFrontReset(front));
    PetscCall(PetscFree(front->place[0]));
    PetscCall(PetscFree(front->place[1]));
    PetscCall(PetscFree(front->panel));
    PetscCall(PetscFree(front->columns));
  }
  PetscCall(PetscFree((*tree)->front));
  PetscCall(PetscFree(*tree));
  PetscFunctionReturn(0);
}

/* Entries of the lower triangle of what a group passes on, per rank. */
static PetscReal Triangle(PetscInt n, EqmGrid grid)
{
  return .5 * (PetscReal)n * (PetscReal)(n + 1) / EqmGridSize(grid);
}

PetscErrorCode EqmInterfaceGetCost(EqmInterface tree, EqmInterfaceCost *cost)
{
  PetscReal panels = 0., passed = PetscSqr((PetscReal)tree->num_shared), most = passed;
  PetscInt mine[3] = {tree->num_shared, tree->num_shared, 1}, all[3];

  PetscFunctionBegin;
  cost->flops = 0.;
  for (PetscInt k = 0; k < tree->num_fronts; k++) {
    const EqmFront *const front = &tree->front[k];
    const PetscReal out = front->num_out, kept = front->num_kept;
    const PetscInt size = front->num_out + front->num_kept;
    PetscReal moved = EqmGridHas(front->from_grid[front->side], tree->rank)
                          ? Triangle(front->num_from[front->side], front->from_grid[front->side])
                          : 0.;
    most = PetscMax(most, panels + passed + moved);
    panels += (PetscReal)front->rows * (PetscReal)front->out_columns;
    passed = (PetscReal)front->kept_rows * (PetscReal)front->kept_columns;
    if (EqmFrontHas(front, tree->rank)) /* a message of either group */
      moved += PetscMax(Triangle(front->num_from[0], front->from_grid[0]),
                        Triangle(front->num_from[1], front->from_grid[1])) /
               EqmGridSize(front->grid);
    most = PetscMax(most, panels + passed + moved);
    mine[0] = PetscMax(mine[0], size);
    if (!EqmFrontIsShared(front)) mine[1] = PetscMax(mine[1], size);
    mine[2] = PetscMax(mine[2], EqmGridSize(front->grid));
    if (front->low == tree->rank) cost->flops += out * out * out / 3. + kept * out * out + kept * kept * out;
  }
  cost->bytes = most * (PetscReal)sizeof(PetscScalar);
  PetscCall(MPIU_Allreduce(mine, all, 3, MPIU_INT, MPI_MAX, tree->comm));
  cost->largest = all[0];
  cost->largest_on_one = all[1];
  cost->most_ranks = all[2];
  PetscFunctionReturn(0);
}
