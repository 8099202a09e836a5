/* Remove duplicate cells, cut a surface apart where it is not a manifold, reorient cells that disagree with their
   neighbours. */
#include "prepare/step.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/sets.h"

/* What is done to the cells: per corner of a cell the copy of its vertex that it gets, -1: the vertex itself. */
typedef struct {
  PetscInt *copy; /* cell_size * num_cells, numbers within the group of copies */
  EqmVertexGroup group;
  PetscInt capacity;
  PetscInt64 cut; /* vertices of which there are copies */
} Cut;

/* The fans of an owned vertex: triangles of its star that are connected through edges of two triangles (Gueziec et al.
   2001). `fan` is per triangle of the star the first one of its fan. */
static void FindFans(const EqmVicinity *vicinity, PetscInt v, const EqmLink *link, PetscInt *place, PetscInt *fan)
{
  const PetscInt start = vicinity->star_start[v], n = vicinity->star_start[v + 1] - start;

  for (PetscInt k = 0; k < n; k++) {
    fan[k] = k;
    place[vicinity->star[start + k]] = k;
  }
  for (PetscInt i = 0; i < link->num_vertices; i++) {
    const PetscInt *const cell = link->edge_cell + 2 * i;

    if (link->leaving[i] + link->entering[i] == 2) (void)EqmSetJoin(fan, place[cell[0]], place[cell[1]]);
  }
  for (PetscInt k = 0; k < n; k++) fan[k] = EqmSetRoot(fan, k);
}

/* The fan that keeps the vertex: the one of most triangles, of equal ones that with the lowest. */
static PetscInt LargestFan(PetscInt n, const PetscInt *fan, PetscInt *size)
{
  PetscInt best = 0;

  for (PetscInt k = 0; k < n; k++) size[k] = 0;
  for (PetscInt k = 0; k < n; k++) size[fan[k]]++;
  for (PetscInt k = 1; k < n; k++) {
    if (size[k] > size[best]) best = k;
  }
  return best;
}

/* Give every fan of a vertex but one a copy of the vertex. */
static PetscErrorCode CutVertex(const EqmVicinity *vicinity, PetscInt v, const PetscInt *fan, PetscInt *number,
                                Cut *cut)
{
  const PetscInt start = vicinity->star_start[v], n = vicinity->star_start[v + 1] - start;
  const PetscInt kept = LargestFan(n, fan, number);
  EqmVertexGroup *const group = &cut->group;

  PetscFunctionBegin;
  if (number[kept] == n) PetscFunctionReturn(0); /* one fan */
  cut->cut++;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt cell = vicinity->star[start + k];

    if (fan[k] == kept) continue;
    if (fan[k] == k) {
      if (group->num_local == cut->capacity) {
        cut->capacity = PetscMax(64, 2 * cut->capacity);
        PetscCall(PetscRealloc((size_t)(3 * cut->capacity) * sizeof(PetscReal), &group->position));
      }
      for (int c = 0; c < 3; c++) group->position[3 * group->num_local + c] = vicinity->position[3 * v + c];
      number[k] = group->num_local++;
    }
    for (PetscInt a = 0; a < 3; a++) {
      if (vicinity->cells[3 * cell + a] == v) cut->copy[3 * cell + a] = number[fan[k]];
    }
  }
  PetscFunctionReturn(0);
}

/* Send copies to the owners of the cells, whose corners they are. */
static PetscErrorCode SendCopies(const EqmVicinity *vicinity, Cut *cut)
{
  PetscInt count = 0, num_received, *records, *received;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * vicinity->num_cells; k++) {
    if (cut->copy[k] >= 0) cut->copy[k] += cut->group.start;
    count += cut->copy[k] >= 0;
  }
  PetscCall(PetscMalloc2(3 * count, &records, count, &destination));
  count = 0;
  for (PetscInt k = 0; k < 3 * vicinity->num_cells; k++) {
    if (cut->copy[k] < 0) continue;
    records[3 * count] = vicinity->cell_input[k / 3];
    records[3 * count + 1] = k % 3;
    records[3 * count + 2] = cut->copy[k];
    PetscCall(PetscLayoutFindOwner(vicinity->layout, vicinity->input[EqmVicinityCellOwnerVertex(vicinity, k / 3)],
                                   &destination[count++]));
  }
  PetscCall(EqmExchange(vicinity->comm, count, 3, destination, records, &num_received, &received));
  for (PetscInt k = 0; k < num_received; k++) {
    PetscInt cell;

    PetscCall(PetscFindInt(received[3 * k], vicinity->num_cells, vicinity->cell_input, &cell));
    cut->copy[3 * cell + received[3 * k + 1]] = received[3 * k + 2];
  }
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(records, destination));
  PetscFunctionReturn(0);
}

/* Cut the surface apart at every vertex with several fans. */
static PetscErrorCode CutApart(const EqmVicinity *vicinity, Cut *cut)
{
  PetscInt *place, *fan, *number, largest = 1;
  EqmLink link;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    largest = PetscMax(largest, vicinity->star_start[v + 1] - vicinity->star_start[v]);
  }
  PetscCall(PetscMalloc3(vicinity->num_cells, &place, largest, &fan, largest, &number));
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    EqmLinkCompute(vicinity, v, &link);
    if (!link.num_vertices || link.regular) continue;
    FindFans(vicinity, v, &link, place, fan);
    PetscCall(CutVertex(vicinity, v, fan, number, cut));
  }
  PetscCall(EqmLinkReset(&link));
  PetscCall(PetscFree3(place, fan, number));
  PetscCall(EqmVertexGroupPlace(vicinity->comm, &cut->group));
  PetscCall(SendCopies(vicinity, cut));
  PetscFunctionReturn(0);
}

/* This rank's own cells as they are after the cut, turned or not. */
static PetscErrorCode ListCells(const EqmVicinity *vicinity, const Cut *cut, PetscInt num_kept, const PetscBool *turn,
                                EqmCellList *list, PetscInt64 *turned)
{
  const PetscInt cs = vicinity->cell_size;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscInt vertex[4], last;

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    for (PetscInt a = 0; a < cs; a++) {
      const PetscInt copy = cut->copy[cs * c + a];
      vertex[a] = copy < 0 ? vicinity->input[vicinity->cells[cs * c + a]] : num_kept + copy;
    }
    last = vertex[cs - 1];
    if (turn[c]) {
      vertex[cs - 1] = vertex[cs - 2];
      vertex[cs - 2] = last;
      ++*turned;
    }
    PetscCall(EqmCellListAdd(list, vicinity->cell_input[c], vertex));
  }
  PetscFunctionReturn(0);
}

/* For solids only duplicates and orientation: other defects have no safe repair. `count` is of all changes.
 */
PetscErrorCode EqmStepSplit(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  const PetscInt cs = change->soup->cell_size, num_kept = change->soup->num_vertices;
  EqmVicinity vicinity;
  EqmCellList list = {.cell_size = cs};
  Cut cut = {0};
  PetscInt64 count[4] = {0, 0, 0, 0}; /* repeated, duplicates, cut, turned */
  PetscBool *turn;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(EqmCellListAddUnusable(change->soup, &list, &count[0]));
  PetscCall(EqmVicinityRemoveDuplicates(&vicinity, &count[1]));
  PetscCall(PetscMalloc2(cs * vicinity.num_cells, &cut.copy, vicinity.num_cells, &turn));
  for (PetscInt k = 0; k < cs * vicinity.num_cells; k++) cut.copy[k] = -1;
  if (cs == 3) PetscCall(CutApart(&vicinity, &cut));
  PetscCall(EqmVicinityChooseTurns(change->soup, &vicinity, turn));
  PetscCall(ListCells(&vicinity, &cut, num_kept, turn, &list, &count[3]));
  count[2] = cut.cut;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 4, MPIU_INT64, MPI_SUM, vicinity.comm));
  report->count = count[0] + count[1] + count[2] + count[3];
  PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                          "%" PetscInt64_FMT " flat and %" PetscInt64_FMT
                          " duplicate cells removed, cut apart at %" PetscInt64_FMT " vertices, %" PetscInt64_FMT
                          " cells turned",
                          count[0], count[1], count[2], count[3]));
  if (report->count) {
    cut.group.start = 0;
    PetscCall(EqmChangeAssemble(change, &cut.group, &list));
  }
  if (!report->count) PetscCall(PetscFree(list.records));
  PetscCall(PetscFree(cut.group.position));
  PetscCall(PetscFree2(cut.copy, turn));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}

/* EqmSoupRepair as a step. */
PetscErrorCode EqmStepRepair(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  EqmRepair *const r = &change->repair;
  EqmSoup repaired;
  PetscInt *parent;

  PetscFunctionBegin;
  PetscCall(EqmSoupCopy(change->soup, &repaired));
  PetscCall(EqmSoupRepairWith(&repaired, (PetscBool)!options->keeps_cells, r, &parent));
  report->count = r->duplicate_cells_removed + r->degenerate_cells_removed + r->cells_flipped + r->cells_split;
  PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                          "%" PetscInt64_FMT " duplicates and %" PetscInt64_FMT
                          " cells with a repeated vertex removed, %" PetscInt64_FMT " cells turned, %" PetscInt64_FMT
                          " cells split with %" PetscInt64_FMT " new vertices",
                          r->duplicate_cells_removed, r->degenerate_cells_removed, r->cells_flipped, r->cells_split,
                          r->vertices_added));
  if (report->count) {
    PetscCall(EqmSoupDestroy(&change->soup));
    change->soup = repaired;
    change->parent = parent;
  } else {
    PetscCall(EqmSoupDestroy(&repaired));
    PetscCall(PetscFree(parent));
  }
  PetscFunctionReturn(0);
}
