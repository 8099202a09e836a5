/* New vertices on edges. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"

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
