/* New vertices on edges, and a new soup from an old one, added vertices and children of cells. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/rows.h"

/* Fill in where a group's local vertices stand in the whole. Collective. */
PetscErrorCode EqmVertexGroupPlace(MPI_Comm comm, EqmVertexGroup *group)
{
  PetscInt end;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&group->num_local, &end, 1, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(&group->num_local, &group->num_global, 1, MPIU_INT, MPI_SUM, comm));
  group->start = end - group->num_local;
  PetscFunctionReturn(0);
}

/* The neighbours w of v for which the edge v-w gets a vertex and belongs to this rank, ascending. */
static PetscErrorCode ChooseEdges(const EqmVicinity *vicinity, PetscInt v, const EqmLink *link,
                                  const PetscBool *on_boundary, PetscInt *count, PetscInt *neighbor)
{
  PetscFunctionBegin;
  *count = 0;
  for (PetscInt i = 0; i < link->num_vertices; i++) {
    const PetscInt w = link->vertex[i];

    if (vicinity->input[w] < vicinity->input[v]) continue;
    if (on_boundary && (link->on_boundary[i] || !on_boundary[v] || !on_boundary[w])) continue;
    neighbor[(*count)++] = w;
  }
  /* later than an owned vertex, local order is input order */
  PetscCall(PetscSortInt(*count, neighbor));
  PetscFunctionReturn(0);
}

/* Enter the new vertices on the edges from v to its neighbours (`fresh`, -1: none) into the cells around v. */
static void NoteInStar(const EqmVicinity *vicinity, PetscInt v, const PetscInt *fresh, PetscInt *edge_vertex)
{
  const int cs = (int)vicinity->cell_size, num_edges = EqmCellNumEdges(cs);

  for (PetscInt s = vicinity->star_start[v]; s < vicinity->star_start[v + 1]; s++) {
    const PetscInt cell = vicinity->star[s], *const corner = vicinity->cells + cs * cell;

    for (int a = 0; a < cs; a++) {
      for (int b = a + 1; b < cs; b++) {
        const PetscInt other = corner[a] == v ? corner[b] : corner[a];

        if ((corner[a] != v && corner[b] != v) || fresh[other] < 0) continue;
        edge_vertex[num_edges * cell + EqmCellEdgeBetween(cs, a, b)] = fresh[other];
      }
    }
  }
}

/* Number the new vertices on this rank's edges, and note them in the cells around. */
static PetscErrorCode NumberOwnEdges(const EqmVicinity *vicinity, const PetscBool *on_boundary,
                                     EqmVertexGroup *midpoints, PetscInt *edge_vertex)
{
  PetscInt capacity = 1024, *fresh, *neighbor;
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(EqmLinkCreate(vicinity, &link));
  PetscCall(PetscMalloc2(vicinity->num_local, &fresh, vicinity->num_local, &neighbor));
  PetscCall(PetscMalloc1(3 * capacity, &midpoints->position));
  for (PetscInt v = 0; v < vicinity->num_local; v++) fresh[v] = -1;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    PetscInt count;

    if (on_boundary && !on_boundary[v]) continue;
    EqmLinkCompute(vicinity, v, &link);
    PetscCall(ChooseEdges(vicinity, v, &link, on_boundary, &count, neighbor));
    if (midpoints->num_local + count > capacity) {
      capacity = 2 * (midpoints->num_local + count);
      PetscCall(PetscRealloc(3 * capacity * sizeof(PetscReal), &midpoints->position));
    }
    for (PetscInt i = 0; i < count; i++) {
      PetscReal *const x = midpoints->position + 3 * midpoints->num_local;

      for (int k = 0; k < 3; k++) {
        x[k] = 0.5 * (vicinity->position[3 * v + k] + vicinity->position[3 * neighbor[i] + k]);
      }
      fresh[neighbor[i]] = midpoints->num_local++;
    }
    if (count) NoteInStar(vicinity, v, fresh, edge_vertex);
    for (PetscInt i = 0; i < count; i++) fresh[neighbor[i]] = -1;
  }
  PetscCall(PetscFree2(fresh, neighbor));
  PetscCall(EqmLinkReset(&link));
  PetscFunctionReturn(0);
}

/* Tell the owners of cells about new vertices on edges that are not theirs. */
static PetscErrorCode TellCellOwners(const EqmVicinity *vicinity, PetscInt *edge_vertex)
{
  const int num_edges = EqmCellNumEdges(vicinity->cell_size);
  PetscInt count = 0, num_received, *records, *received;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  if (vicinity->size == 1) PetscFunctionReturn(0);
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (EqmVicinityCellOwnerVertex(vicinity, c) < vicinity->num_owned) continue;
    for (int e = 0; e < num_edges; e++) count += edge_vertex[num_edges * c + e] >= 0;
  }
  PetscCall(PetscMalloc2(3 * count, &records, count, &destination));
  count = 0;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    const PetscInt vertex = EqmVicinityCellOwnerVertex(vicinity, c);

    if (vertex < vicinity->num_owned) continue;
    for (int e = 0; e < num_edges; e++) {
      if (edge_vertex[num_edges * c + e] < 0) continue;
      records[3 * count] = vicinity->cell_input[c];
      records[3 * count + 1] = e;
      records[3 * count + 2] = edge_vertex[num_edges * c + e];
      PetscCall(PetscLayoutFindOwner(vicinity->layout, vicinity->input[vertex], &destination[count++]));
    }
  }
  PetscCall(EqmExchange(vicinity->comm, count, 3, destination, records, &num_received, &received));
  for (PetscInt k = 0; k < num_received; k++) {
    PetscInt cell;

    PetscCall(PetscFindInt(received[3 * k], vicinity->num_cells, vicinity->cell_input, &cell));
    edge_vertex[num_edges * cell + received[3 * k + 1]] = received[3 * k + 2];
  }
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(records, destination));
  PetscFunctionReturn(0);
}

/* Put a vertex on the middle of every edge, or with `on_boundary` (per local vertex) only of every interior edge
   between two boundary vertices. They are numbered in the order of their edges, on any number of ranks: `midpoints` is
   the group of them (free its positions). `edge_vertex`, EqmCellNumEdges per cell, gets for this rank's own cells the
   numbers within the group, or -1. Collective. */
PetscErrorCode EqmEdgesNumber(const EqmVicinity *vicinity, const PetscBool *on_boundary, EqmVertexGroup *midpoints,
                              PetscInt *edge_vertex)
{
  const PetscInt num_entries = EqmCellNumEdges(vicinity->cell_size) * vicinity->num_cells;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(midpoints, sizeof(*midpoints)));
  for (PetscInt k = 0; k < num_entries; k++) edge_vertex[k] = -1;
  PetscCall(NumberOwnEdges(vicinity, on_boundary, midpoints, edge_vertex));
  PetscCall(EqmVertexGroupPlace(vicinity->comm, midpoints));
  for (PetscInt k = 0; k < num_entries; k++) {
    if (edge_vertex[k] >= 0) edge_vertex[k] += midpoints->start;
  }
  PetscCall(TellCellOwners(vicinity, edge_vertex));
  PetscFunctionReturn(0);
}

/* Append a cell; the list starts out as {.cell_size = ..}. Not collective. */
PetscErrorCode EqmCellListAdd(EqmCellList *list, PetscInt parent, const PetscInt *vertices)
{
  const PetscInt width = 1 + list->cell_size;
  PetscInt *record;

  PetscFunctionBegin;
  if (list->count == list->capacity) {
    list->capacity = PetscMax(1024, 2 * list->capacity);
    PetscCall(PetscRealloc(width * list->capacity * sizeof(PetscInt), &list->records));
  }
  record = list->records + width * list->count++;
  record[0] = parent;
  for (PetscInt a = 0; a < list->cell_size; a++) record[1 + a] = vertices[a];
  PetscFunctionReturn(0);
}

/* Where the vertices low .. high - 1 of a group are: who holds them, and at which of its places, `offset` vertices of
   other groups coming before. */
static PetscErrorCode FindHolders(MPI_Comm comm, const EqmVertexGroup *group, PetscInt offset, PetscInt low,
                                  PetscInt high, PetscSFNode *node)
{
  PetscLayout layout;
  PetscInt *offsets;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, group->num_local, group->num_global, 1, &layout));
  PetscCall(PetscMalloc1(layout->size, &offsets));
  PetscCallMPI(MPI_Allgather(&offset, 1, MPIU_INT, offsets, 1, MPIU_INT, comm));
  for (PetscInt v = low; v < high; v++) {
    PetscSFNode *const place = &node[v - low];
    PetscMPIInt owner;

    PetscCall(PetscLayoutFindOwnerIndex(layout, v, &owner, &place->index));
    place->rank = owner;
    place->index += offsets[owner];
  }
  PetscCall(PetscFree(offsets));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

/* Positions of the groups' vertices, one group after the other, dealt out in even slabs. */
static PetscErrorCode DealVertices(MPI_Comm comm, PetscInt num_groups, const EqmVertexGroup *groups,
                                   PetscInt *num_local, PetscReal **position)
{
  PetscInt num_global = 0, num_roots = 0, start, end, first = 0, offset = 0;
  PetscReal *held;
  PetscSFNode *node;
  PetscSF sf;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < num_groups; g++) {
    num_global += groups[g].num_global;
    num_roots += groups[g].num_local;
  }
  *num_local = PETSC_DECIDE;
  PetscCall(PetscSplitOwnership(comm, num_local, &num_global));
  PetscCallMPI(MPI_Scan(num_local, &end, 1, MPIU_INT, MPI_SUM, comm));
  start = end - *num_local;
  PetscCall(PetscMalloc1(3 * num_roots, &held));
  PetscCall(PetscMalloc1(*num_local, &node));
  for (PetscInt g = 0; g < num_groups; g++) {
    const PetscInt low = PetscMax(first, start), high = PetscMin(first + groups[g].num_global, end);
    PetscCall(FindHolders(comm, &groups[g], offset, low - first, high - first, node + (low - start)));
    PetscCall(PetscArraycpy(held + 3 * offset, groups[g].position, 3 * groups[g].num_local));
    first += groups[g].num_global;
    offset += groups[g].num_local;
  }
  PetscCall(PetscSFCreate(comm, &sf));
  PetscCall(PetscSFSetGraph(sf, num_roots, *num_local, NULL, PETSC_OWN_POINTER, node, PETSC_OWN_POINTER));
  PetscCall(PetscMalloc1(3 * *num_local, position));
  PetscCall(EqmRowsToLeaves(sf, 3, held, *position));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree(held));
  PetscFunctionReturn(0);
}

/* The place of a parent in the slab; behind it for none. */
static PetscInt PlaceOfParent(EqmSoup soup, PetscInt parent)
{
  return parent < 0 ? soup->cell_end - soup->cell_start : parent - soup->cell_start;
}

/* Bring the new cells to the ranks that held their parents, in the order of the parents; those without a parent, in the
   order of the ranks that made them, to the end. */
static PetscErrorCode DealCells(EqmSoup soup, EqmCellList *list, PetscInt *num_cells, PetscInt **cells,
                                PetscInt **parent)
{
  const PetscInt cs = list->cell_size, width = 1 + cs, num_parents = soup->cell_end - soup->cell_start;
  PetscInt *received, *start;
  PetscMPIInt *destination;
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, num_parents, soup->num_cells, 1, &layout));
  PetscCall(PetscMalloc1(list->count, &destination));
  for (PetscInt k = 0; k < list->count; k++) {
    destination[k] = layout->size - 1;
    if (list->records[width * k] >= 0)
      PetscCall(PetscLayoutFindOwner(layout, list->records[width * k], &destination[k]));
  }
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(EqmExchange(soup->comm, list->count, width, destination, list->records, num_cells, &received));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(list->records));
  PetscCall(PetscCalloc1(num_parents + 2, &start));
  for (PetscInt k = 0; k < *num_cells; k++) start[PlaceOfParent(soup, received[width * k]) + 1]++;
  for (PetscInt p = 0; p <= num_parents; p++) start[p + 1] += start[p];
  PetscCall(PetscMalloc1(cs * *num_cells, cells));
  PetscCall(PetscMalloc1(*num_cells, parent));
  for (PetscInt k = 0; k < *num_cells; k++) {
    const PetscInt place = start[PlaceOfParent(soup, received[width * k])]++;

    (*parent)[place] = received[width * k];
    for (PetscInt a = 0; a < cs; a++) (*cells)[cs * place + a] = received[width * k + 1 + a];
  }
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(received));
  PetscFunctionReturn(0);
}

/* Replace a soup by one with the vertices of the groups (the old ones are group 0) and the cells of the list, which is
   used up; children stand where their parents stood and inherit their density; cells without a parent (-1) come last
   and have the density 1. `parent` (PetscFree it) has the old input number per cell of the new slab. Collective. */
PetscErrorCode EqmSoupAssemble(EqmSoup *soup, PetscInt num_groups, const EqmVertexGroup *groups, EqmCellList *list,
                               PetscInt **parent)
{
  PetscInt num_vertices, num_cells, *cells;
  PetscReal *vertices, *density = NULL;
  EqmSoup made;

  PetscFunctionBegin;
  PetscCall(DealVertices((*soup)->comm, num_groups, groups, &num_vertices, &vertices));
  PetscCall(DealCells(*soup, list, &num_cells, &cells, parent));
  if ((*soup)->density) {
    PetscCall(PetscMalloc1(num_cells + 1, &density)); /* never NULL: that would say that there is none */
    for (PetscInt c = 0; c < num_cells; c++) {
      density[c] = (*parent)[c] < 0 ? 1. : (*soup)->density[PlaceOfParent(*soup, (*parent)[c])];
    }
  }
  PetscCall(EqmSoupCreateFromSlabs((*soup)->comm, (*soup)->cell_size, num_vertices, vertices, num_cells, cells,
                                   (*soup)->file, &made));
  made->density = density;
  PetscCall(EqmSoupDestroy(soup));
  *soup = made;
  PetscFunctionReturn(0);
}
