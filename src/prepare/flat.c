/* Mend flat triangles: they and all that touches them, which is little, are gathered on one rank. */
#include "prepare/flat.h"
#include "base/exchange.h"
#include "base/sort.h"
#include "mesh/soup_private.h"

/* Mark the vertices of flat triangles, ghosts included; false: there is none. */
static PetscErrorCode MarkFlat(const EqmVicinity *vicinity, PetscBool *marked, PetscBool *found)
{
  PetscInt local = 0, total;
  PetscInt *flag;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(vicinity->num_local, &flag));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscReal quality;

    (void)EqmCellMeasure(vicinity, c, &quality);
    for (int a = 0; a < 3 && quality < EQM_FLAT_TRIANGLE; a++) local = flag[vicinity->cells[3 * c + a]] = 1;
  }
  PetscCallMPI(MPI_Allreduce(&local, &total, 1, MPIU_INT, MPI_MAX, vicinity->comm));
  PetscCall(PetscSFBcastBegin(vicinity->ghosts, MPIU_INT, flag, flag, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(vicinity->ghosts, MPIU_INT, flag, flag, MPI_REPLACE));
  for (PetscInt v = 0; v < vicinity->num_local; v++) marked[v] = (PetscBool)flag[v];
  PetscCall(PetscFree(flag));
  *found = (PetscBool)(total > 0);
  PetscFunctionReturn(0);
}

static int CompareRecords(const void *a, const void *b)
{
  const EqmFlatRecord *const s = a, *const t = b;
  return (s->cell > t->cell) - (s->cell < t->cell);
}

/* Send this rank's own cells with a marked vertex to rank 0, which makes the patch of them, in the order of the mesh.
 */
static PetscErrorCode GatherPatch(const EqmVicinity *vicinity, const PetscBool *marked, EqmFlatPatch *patch)
{
  PetscInt count = 0, num;
  PetscMPIInt *destination;
  EqmFlatRecord *mine, *all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(vicinity->num_cells, &mine));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    const PetscInt *const v = vicinity->cells + 3 * c;

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    if (!marked[v[0]] && !marked[v[1]] && !marked[v[2]]) continue;
    mine[count].cell = vicinity->cell_input[c];
    for (int a = 0; a < 3; a++) {
      mine[count].vertex[a] = vicinity->input[v[a]];
      PetscCall(PetscArraycpy(mine[count].x + 3 * a, vicinity->position + 3 * v[a], 3));
    }
    count++;
  }
  PetscCall(PetscCalloc1(count, &destination));
  PetscCall(EqmExchangeBytes(vicinity->comm, count, sizeof(*mine), destination, mine, &num, &all));
  EqmSort(all, (size_t)num, sizeof(*all), CompareRecords);
  PetscCall(EqmFlatPatchCreate(num, all, patch));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(mine));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}

/* Rank 0's ascending list to all ranks; it is short. */
static PetscErrorCode Share(MPI_Comm comm, PetscInt *num, PetscInt **list)
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(num, 1, MPIU_INT, 0, comm));
  if (!*list) PetscCall(PetscMalloc1(*num + 1, list));
  PetscCall(PetscMPIIntCast(*num, &count));
  PetscCallMPI(MPI_Bcast(*list, count, MPIU_INT, 0, comm));
  PetscFunctionReturn(0);
}

/* Keep the cells that have not been replaced, and add on rank 0 those in their place. */
static PetscErrorCode ListCells(EqmSoup soup, const EqmFlatPatch *patch, EqmCellList *list)
{
  PetscInt num_replaced = 0, *replaced = NULL;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  if (rank == 0) PetscCall(PetscMalloc1(patch->num_given + 1, &replaced));
  for (PetscInt c = 0; c < patch->num_given; c++) {
    if (!patch->alive[c]) replaced[num_replaced++] = patch->cell[c]; /* ascending */
  }
  PetscCall(Share(soup->comm, &num_replaced, &replaced));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    PetscInt found;

    PetscCall(PetscFindInt(c, num_replaced, replaced, &found));
    if (found < 0) PetscCall(EqmCellListAdd(list, c, soup->cells + 3 * (c - soup->cell_start)));
  }
  for (PetscInt c = patch->num_given; c < patch->num_cells; c++) {
    const PetscInt *const v = patch->corner + 3 * c;
    const PetscInt vertex[3] = {patch->number[v[0]], patch->number[v[1]], patch->number[v[2]]};

    if (patch->alive[c]) PetscCall(EqmCellListAdd(list, patch->cell[c], vertex));
  }
  PetscCall(PetscFree(replaced));
  PetscFunctionReturn(0);
}

/* What became of the vertices: those that were joined have the number of the other one. */
static PetscErrorCode Renumber(EqmFlatPatch *patch, EqmChange *change)
{
  PetscInt num = patch->num_joined, *from = NULL, *to = NULL, *last = NULL;
  const MPI_Comm comm = change->soup->comm;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) PetscCall(PetscMalloc2(num + 1, &from, num + 1, &to));
  PetscCall(PetscMalloc1(patch->num_vertices, &last)); /* per vertex of the patch: where it ends */
  for (PetscInt v = 0; v < patch->num_vertices; v++) last[v] = v;
  for (PetscInt k = num - 1; k >= 0; k--) { /* a vertex that others went to may itself have gone on later */
    last[patch->joined[k]] = last[patch->onto[k]];
    from[k] = patch->number[patch->joined[k]];
    to[k] = patch->number[last[patch->joined[k]]];
  }
  PetscCall(PetscFree(last));
  PetscCall(PetscSortIntWithArray(num, from, to));
  PetscCallMPI(MPI_Bcast(&num, 1, MPIU_INT, 0, comm));
  if (rank) PetscCall(PetscMalloc2(num + 1, &from, num + 1, &to));
  PetscCall(Share(comm, &num, &from));
  PetscCall(Share(comm, &num, &to));
  PetscCall(EqmChangeRenumber(change, num, from, to));
  PetscCall(PetscFree2(from, to));
  PetscFunctionReturn(0);
}

/* `count` is of triangles. Cells that name a vertex twice are left to `split`. */
PetscErrorCode EqmStepFlat(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  EqmCellList list = {.cell_size = 3};
  EqmVicinity vicinity;
  EqmFlatPatch patch;
  PetscBool *marked, found;

  PetscFunctionBegin;
  if (change->soup->cell_size != 3) PetscFunctionReturn(0);
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(PetscMalloc1(vicinity.num_local, &marked));
  PetscCall(MarkFlat(&vicinity, marked, &found));
  if (found) {
    PetscCall(GatherPatch(&vicinity, marked, &patch));
    PetscCall(EqmFlatPatchMend(&patch, &report->count)); /* those of rank 0 */
    PetscCallMPI(MPI_Bcast(&report->count, 1, MPIU_INT64, 0, vicinity.comm));
    if (report->count) {
      PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                              "%" PetscInt64_FMT " triangles without area flipped or collapsed", report->count));
      PetscCall(ListCells(change->soup, &patch, &list));
      PetscCall(Renumber(&patch, change));
      PetscCall(EqmChangeAssemble(change, NULL, &list));
    }
    PetscCall(EqmFlatPatchReset(&patch));
  }
  PetscCall(PetscFree(marked));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}
