/* Repair what can be repaired without a choice: duplicates, repeated vertices, orientation, cells with all vertices on
   the boundary. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"

/* What is done to a cell with all new vertices known. */
typedef struct {
  PetscInt end[EQM_MAX_CELL_EDGES][2], middle[EQM_MAX_CELL_EDGES]; /* edges to cut, and where */
  int num_cuts;
} Cuts;

/* A vertex in the middle of every own cell that has no interior vertex and no edge to cut; `center` gets its number
   within the group, or -1. */
static PetscErrorCode NumberCenters(const EqmVicinity *vicinity, const PetscBool *on_boundary,
                                    const PetscInt *edge_vertex, EqmVertexGroup *centers, PetscInt *center)
{
  const PetscInt cs = vicinity->cell_size;
  const int num_edges = EqmCellNumEdges(cs);
  PetscInt capacity = 0;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(centers, sizeof(*centers)));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) center[c] = -1;
  /* vertex by vertex, not in the order of the cells: the same for any number of ranks */
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    for (PetscInt s = vicinity->star_start[v]; s < vicinity->star_start[v + 1]; s++) {
      const PetscInt cell = vicinity->star[s], *const corner = vicinity->cells + cs * cell;
      PetscBool stays = PETSC_FALSE;

      if (EqmVicinityCellOwnerVertex(vicinity, cell) != v) continue;
      for (PetscInt a = 0; a < cs; a++) stays = (PetscBool)(stays || !on_boundary[corner[a]]);
      for (int e = 0; e < num_edges; e++) stays = (PetscBool)(stays || edge_vertex[num_edges * cell + e] >= 0);
      if (stays) continue;
      if (centers->num_local == capacity) {
        capacity = PetscMax(64, 2 * capacity);
        PetscCall(PetscRealloc(3 * capacity * sizeof(PetscReal), &centers->position));
      }
      for (int k = 0; k < 3; k++) {
        PetscReal sum = 0.0;

        for (PetscInt a = 0; a < cs; a++) sum += vicinity->position[3 * corner[a] + k];
        centers->position[3 * centers->num_local + k] = sum / cs;
      }
      center[cell] = centers->num_local++;
    }
  }
  PetscCall(EqmVertexGroupPlace(vicinity->comm, centers));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (center[c] >= 0) center[c] += centers->start;
  }
  PetscFunctionReturn(0);
}

/* Cut a cell in two at the new vertex of lowest number on its edges, and so on with the halves. All cells at an edge
   cut it in the same order, so that their common faces are cut alike. */
static PetscErrorCode AddBisected(const Cuts *cuts, PetscInt parent, const PetscInt vertex[], EqmCellList *list)
{
  int cut = -1, place[2] = {-1, -1};

  PetscFunctionBegin;
  for (int e = 0; e < cuts->num_cuts; e++) {
    int found[2] = {-1, -1};

    for (int a = 0; a < list->cell_size; a++) {
      if (vertex[a] == cuts->end[e][0]) found[0] = a;
      if (vertex[a] == cuts->end[e][1]) found[1] = a;
    }
    if (found[0] < 0 || found[1] < 0 || (cut >= 0 && cuts->middle[cut] < cuts->middle[e])) continue;
    cut = e;
    place[0] = found[0];
    place[1] = found[1];
  }
  if (cut < 0) {
    PetscCall(EqmCellListAdd(list, parent, vertex));
    PetscFunctionReturn(0);
  }
  for (int half = 0; half < 2; half++) {
    PetscInt child[4];

    for (int a = 0; a < list->cell_size; a++) child[a] = a == place[half] ? cuts->middle[cut] : vertex[a];
    PetscCall(AddBisected(cuts, parent, child, list));
  }
  PetscFunctionReturn(0);
}

/* Add what becomes of one cell; `middle` and `center` are numbers of new vertices or -1. */
static PetscErrorCode AddRepaired(PetscInt parent, const PetscInt vertex[], const PetscInt middle[], PetscInt center,
                                  EqmCellList *list)
{
  Cuts cuts = {.num_cuts = 0};

  PetscFunctionBegin;
  for (PetscInt a = 0; center >= 0 && a < list->cell_size; a++) {
    PetscInt child[4];

    for (PetscInt b = 0; b < list->cell_size; b++) child[b] = a == b ? center : vertex[b];
    PetscCall(EqmCellListAdd(list, parent, child));
  }
  if (center >= 0) PetscFunctionReturn(0);
  for (int a = 0; a < list->cell_size; a++) {
    for (int b = a + 1; b < list->cell_size; b++) {
      const PetscInt new_vertex = middle[EqmCellEdgeBetween(list->cell_size, a, b)];

      if (new_vertex < 0) continue;
      cuts.end[cuts.num_cuts][0] = vertex[a];
      cuts.end[cuts.num_cuts][1] = vertex[b];
      cuts.middle[cuts.num_cuts++] = new_vertex;
    }
  }
  PetscCall(AddBisected(&cuts, parent, vertex, list));
  PetscFunctionReturn(0);
}

/* Turned, cut and filled: this rank's own cells go to the list. `groups` are the kept vertices, the midpoints, the
 * centres. */
static PetscErrorCode AddCells(const EqmVicinity *vicinity, const EqmVertexGroup groups[3], const PetscInt *edge_vertex,
                               const PetscInt *center, const PetscBool *turn, EqmRepair *repair, EqmCellList *list)
{
  const PetscInt cs = vicinity->cell_size;
  const PetscInt first_middle = groups[0].num_global, first_center = first_middle + groups[1].num_global;
  const int num_edges = EqmCellNumEdges(cs);

  PetscFunctionBegin;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    PetscInt vertex[4], middle[EQM_MAX_CELL_EDGES], count = list->count;

    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    for (PetscInt a = 0; a < cs; a++) vertex[a] = vicinity->input[vicinity->cells[cs * c + a]];
    for (int e = 0; e < num_edges; e++) {
      const PetscInt place = edge_vertex[num_edges * c + e];

      middle[e] = place < 0 ? -1 : first_middle + place;
    }
    PetscCall(
        AddRepaired(vicinity->cell_input[c], vertex, middle, center[c] < 0 ? -1 : first_center + center[c], list));
    if (list->count > count + 1) repair->cells_split++;
    if (!turn[c]) continue;
    repair->cells_flipped++;
    for (; count < list->count; count++) {
      PetscInt *const child = list->records + (1 + cs) * count + 1, last = child[cs - 1];

      child[cs - 1] = child[cs - 2];
      child[cs - 2] = last;
    }
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCellListAddUnusable(EqmSoup soup, EqmCellList *list, PetscInt64 *repeated)
{
  const PetscInt cs = soup->cell_size;

  PetscFunctionBegin;
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    const PetscInt *const cell = soup->cells + cs * (c - soup->cell_start);
    const EqmCellUse use = EqmSoupCellUse(soup, cell);
    PetscInt vertex[4];

    if (use == EQM_CELL_REPEATED_VERTEX) ++*repeated;
    if (use != EQM_CELL_BAD_INDEX) continue;
    for (PetscInt a = 0; a < cs; a++) vertex[a] = cell[a] >= 0 && cell[a] < soup->num_vertices ? cell[a] : -1;
    PetscCall(EqmCellListAdd(list, c, vertex));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmVicinityRemoveDuplicates(EqmVicinity *vicinity, PetscInt64 *removed)
{
  PetscInt *first;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(vicinity->num_cells, &first));
  PetscCall(EqmVicinityFindDuplicates(vicinity, first));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    *removed += first[c] != c && EqmVicinityCellOwnerVertex(vicinity, c) < vicinity->num_owned;
  }
  PetscCall(EqmVicinityDropDuplicates(vicinity, first));
  PetscCall(PetscFree(first));
  PetscFunctionReturn(0);
}

/* New vertices on edges and in cells, the groups 1 and 2; without `split` none. */
static PetscErrorCode NumberNew(const EqmVicinity *vicinity, PetscBool split, EqmVertexGroup groups[3],
                                PetscInt *edge_vertex, PetscInt *center)
{
  PetscBool *on_boundary;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < EqmCellNumEdges(vicinity->cell_size) * vicinity->num_cells; e++) edge_vertex[e] = -1;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) center[c] = -1;
  if (split) {
    PetscCall(PetscMalloc1(vicinity->num_local, &on_boundary));
    PetscCall(EqmVicinityMarkBoundary(vicinity, on_boundary));
    PetscCall(EqmEdgesNumber(vicinity, on_boundary, &groups[1], edge_vertex));
    PetscCall(NumberCenters(vicinity, on_boundary, edge_vertex, &groups[2], center));
    PetscCall(PetscFree(on_boundary));
  } else {
    PetscCall(EqmVertexGroupPlace(vicinity->comm, &groups[1]));
    PetscCall(EqmVertexGroupPlace(vicinity->comm, &groups[2]));
  }
  PetscFunctionReturn(0);
}

/* Repair the cells of a vicinity: turn, cut, fill. Fills the groups 1 and 2 and the list. */
static PetscErrorCode RepairCells(EqmSoup soup, const EqmVicinity *vicinity, PetscBool split, EqmVertexGroup groups[3],
                                  EqmRepair *repair, EqmCellList *list)
{
  PetscInt *edge_vertex, *center;
  PetscBool *turn;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(EqmCellNumEdges(vicinity->cell_size) * vicinity->num_cells, &edge_vertex, vicinity->num_cells,
                         &center, vicinity->num_cells, &turn));
  PetscCall(EqmVicinityChooseTurns(soup, vicinity, turn));
  PetscCall(NumberNew(vicinity, split, groups, edge_vertex, center));
  PetscCall(AddCells(vicinity, groups, edge_vertex, center, turn, repair, list));
  PetscCall(PetscFree3(edge_vertex, center, turn));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupRepairWith(EqmSoup *soup, PetscBool split, EqmRepair *repair, PetscInt **parent)
{
  EqmVicinity vicinity;
  EqmVertexGroup groups[3] = {
      {.num_local = (*soup)->vertex_end - (*soup)->vertex_start, .position = (*soup)->vertices}};
  EqmCellList list = {.cell_size = (*soup)->cell_size};

  PetscFunctionBegin;
  PetscCall(PetscMemzero(repair, sizeof(*repair)));
  PetscCall(EqmVicinityCreate(*soup, &vicinity));
  PetscCall(EqmCellListAddUnusable(*soup, &list, &repair->degenerate_cells_removed));
  PetscCall(EqmVicinityRemoveDuplicates(&vicinity, &repair->duplicate_cells_removed));
  for (PetscInt v = 0; v < vicinity.num_owned; v++) {
    repair->vertices_unreferenced += vicinity.star_start[v] == vicinity.star_start[v + 1];
  }
  PetscCall(EqmVertexGroupPlace((*soup)->comm, &groups[0]));
  PetscCall(RepairCells(*soup, &vicinity, split, groups, repair, &list));
  PetscCall(EqmVicinityReset(&vicinity));
  repair->vertices_added = groups[1].num_local + groups[2].num_local;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, repair, sizeof(*repair) / sizeof(PetscInt64), MPIU_INT64, MPI_SUM, (*soup)->comm));
  PetscCall(EqmSoupAssemble(soup, 3, groups, &list, parent));
  PetscCall(PetscFree(groups[1].position));
  PetscCall(PetscFree(groups[2].position));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupRepair(EqmSoup *soup, EqmRepair *repair, PetscInt **parent)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupRepairWith(soup, PETSC_TRUE, repair, parent));
  PetscFunctionReturn(0);
}
