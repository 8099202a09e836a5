/* The boundary: its facets, its vertices, and for a disk-type surface the order and arc length of its loop. */
#include "mesh/build.h"
#include "base/narrow.h"
#include "base/sort.h"
#include "mesh/mesh_private.h"

/* The facet opposite a corner, oriented as the boundary of a positively oriented cell. */
static const PetscInt facet_of_triangle[3][2] = {{1, 2}, {2, 0}, {0, 1}};
static const PetscInt facet_of_tetrahedron[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static const PetscInt *FacetCorners(PetscInt cell_size, PetscInt opposite)
{
  return cell_size == 3 ? facet_of_triangle[opposite] : facet_of_tetrahedron[opposite];
}

/* The facet's vertices in ascending order; returns whether one of them is owned. */
static PetscBool FacetKey(EqmMesh mesh, PetscInt cell, PetscInt opposite, PetscInt key[3])
{
  const PetscInt fs = mesh->cell_size - 1, *const corner = FacetCorners(mesh->cell_size, opposite);

  for (PetscInt k = 0; k < fs; k++) {
    PetscInt v = mesh->cells[mesh->cell_size * cell + corner[k]], q = k;
    for (; q > 0 && key[q - 1] > v; q--) key[q] = key[q - 1];
    key[q] = v;
  }
  return (PetscBool)(key[0] < mesh->num_owned);
}

/* Facets, as (cell, corner), grouped by their smallest vertex. Facets of ghosts alone are left out: their other cell
   may be elsewhere. */
static PetscErrorCode GroupFacets(EqmMesh mesh, PetscInt **start, PetscInt **facet)
{
  PetscInt *first, *list, key[3];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(mesh->num_owned + 2, &first));
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++) {
    if (FacetKey(mesh, k / mesh->cell_size, k % mesh->cell_size, key)) first[key[0] + 2]++;
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) first[v + 2] += first[v + 1];
  PetscCall(PetscMalloc1(first[mesh->num_owned + 1], &list));
  for (PetscInt k = 0; k < mesh->cell_size * mesh->num_local_cells; k++) {
    if (FacetKey(mesh, k / mesh->cell_size, k % mesh->cell_size, key)) list[first[key[0] + 1]++] = k;
  }
  *start = first;
  *facet = list;
  PetscFunctionReturn(0);
}

/* The facets of one cell only, as (cell, corner), ordered by their smallest vertex. */
static PetscErrorCode LoneFacets(EqmMesh mesh, PetscInt *count, PetscInt **kept)
{
  const PetscInt cs = mesh->cell_size;
  PetscInt *start, *facet, (*key)[3], most = 0;

  PetscFunctionBegin;
  PetscCall(GroupFacets(mesh, &start, &facet));
  for (PetscInt v = 0; v < mesh->num_owned; v++) most = PetscMax(most, start[v + 1] - start[v]);
  PetscCall(PetscMalloc1(start[mesh->num_owned], kept));
  PetscCall(PetscMalloc1(most, &key));
  *count = 0;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscInt n = start[v + 1] - start[v];

    for (PetscInt q = 0; q < n; q++) {
      key[q][2] = -1; /* of an edge */
      (void)FacetKey(mesh, facet[start[v] + q] / cs, facet[start[v] + q] % cs, key[q]);
    }
    for (PetscInt q = 0; q < n; q++) {
      PetscInt r = 0;
      while (r < n && (r == q || key[r][1] != key[q][1] || key[r][2] != key[q][2])) r++;
      if (r == n) (*kept)[(*count)++] = facet[start[v] + q];
    }
  }
  PetscCall(PetscFree(key));
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(facet));
  PetscFunctionReturn(0);
}

/* Find the facets of one cell only and the vertices on them. Collective. */
PetscErrorCode EqmMeshFindBoundary(EqmMesh mesh)
{
  const PetscInt cs = mesh->cell_size, fs = cs - 1;
  PetscInt *kept, count, num_owned_boundary = 0;
  PetscReal *flag;

  PetscFunctionBegin;
  PetscCall(LoneFacets(mesh, &count, &kept));
  PetscCall(PetscMalloc1(mesh->num_local, &mesh->on_boundary));
  PetscCall(PetscCalloc1(mesh->num_local, &flag));
  PetscCall(PetscMalloc1(fs * count, &mesh->boundary_facets));
  PetscCall(PetscMalloc1(count, &mesh->boundary_order));
  mesh->num_boundary_facets = count;
  for (PetscInt k = 0; k < count; k++) {
    const PetscInt *const corner = FacetCorners(cs, kept[k] % cs);
    mesh->boundary_order[k] = (PetscInt64)((kept[k] % cs + 1) % cs) * mesh->num_cells + mesh->cell_input[kept[k] / cs];
    for (PetscInt a = 0; a < fs; a++) {
      const PetscInt v = mesh->cells[cs * (kept[k] / cs) + corner[a]];
      mesh->boundary_facets[fs * k + a] = v;
      flag[v] = 1.;
    }
  }
  PetscCall(PetscFree(kept));
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, flag));
  for (PetscInt v = 0; v < mesh->num_local; v++) mesh->on_boundary[v] = (PetscBool)(flag[v] > 0.);
  for (PetscInt v = 0; v < mesh->num_owned; v++) num_owned_boundary += mesh->on_boundary[v];
  PetscCall(MPIU_Allreduce(&num_owned_boundary, &mesh->num_boundary_vertices, 1, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(PetscFree(flag));
  PetscFunctionReturn(0);
}

/* One boundary edge as it travels: tail and head (global numbers), place in the file. */
typedef struct {
  PetscInt tail, head;
  PetscInt64 order;
  PetscReal length;
} LoopEdge;

static int CompareTails(const void *a, const void *b)
{
  const PetscInt s = ((const LoopEdge *)a)->tail, t = ((const LoopEdge *)b)->tail;
  return (s > t) - (s < t);
}

/* Where its tail is: which vertex of the loop, and its arc length in [0, 1). */
typedef struct {
  PetscInt place;
  PetscReal arc;
} LoopPlace;

/* Walk along the loop from the edge that the file has first; the edges are sorted by tail. */
static PetscErrorCode WalkLoop(PetscInt n, const LoopEdge *edge, LoopPlace *tail_at, PetscBool *closed)
{
  PetscInt first = 0, current, *tail;
  PetscReal length = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &tail));
  for (PetscInt e = 0; e < n; e++) {
    tail[e] = edge[e].tail;
    tail_at[e].place = -1;
    if (edge[e].order < edge[first].order) first = e;
  }
  current = first;
  for (PetscInt k = 0; k < n && current >= 0 && tail_at[current].place < 0; k++) {
    tail_at[current] = (LoopPlace){k, length};
    length += edge[current].length;
    PetscCall(PetscFindInt(edge[current].head, n, tail, &current));
  }
  *closed = (PetscBool)(n > 0 && current == first);
  for (PetscInt e = 0; e < n; e++) {
    *closed = (PetscBool)(*closed && tail_at[e].place >= 0);
    tail_at[e].arc /= length;
  }
  PetscCall(PetscFree(tail));
  PetscFunctionReturn(0);
}

/* The same for edges in any order. Not collective. */
static PetscErrorCode OrderLoop(PetscInt n, const LoopEdge *edge, LoopPlace *tail_at, PetscBool *closed)
{
  LoopEdge *sorted;
  LoopPlace *walked;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &sorted, n, &walked));
  PetscCall(PetscArraycpy(sorted, edge, n));
  EqmSort(sorted, (size_t)n, sizeof(LoopEdge), CompareTails);
  PetscCall(WalkLoop(n, sorted, walked, closed));
  for (PetscInt e = 0; e < n; e++) {
    const LoopEdge *const found = EqmSearch(&edge[e], sorted, (size_t)n, sizeof(LoopEdge), CompareTails);
    tail_at[e] = walked[found - sorted];
  }
  PetscCall(PetscFree2(sorted, walked));
  PetscFunctionReturn(0);
}

/* A datatype of so many bytes. */
static PetscErrorCode MakeRecord(size_t bytes, MPI_Datatype *record)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)bytes, MPI_BYTE, record));
  PetscCallMPI(MPI_Type_commit(record));
  PetscFunctionReturn(0);
}

/* Order the loop's edges on rank 0, which holds n_B edges for this moment, and hand the places of their tails
   back. */
static PetscErrorCode OrderLoopOnRoot(EqmMesh mesh, PetscInt n, const LoopEdge *mine, LoopPlace *tail_at)
{
  PetscMPIInt *count, *start;
  LoopEdge *all = NULL;
  LoopPlace *all_places = NULL;
  PetscBool closed = PETSC_TRUE;
  MPI_Datatype edge_type, place_type;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->size, &count, mesh->size + 1, &start));
  PetscCall(EqmGatherCounts(mesh->comm, n, "edges of the boundary", count, start));
  if (mesh->rank == 0) PetscCall(PetscMalloc2(start[mesh->size], &all, start[mesh->size], &all_places));
  PetscCall(MakeRecord(sizeof(LoopEdge), &edge_type));
  PetscCall(MakeRecord(sizeof(LoopPlace), &place_type));
  PetscCallMPI(MPI_Gatherv(mine, count[mesh->rank], edge_type, all, count, start, edge_type, 0, mesh->comm));
  if (mesh->rank == 0) PetscCall(OrderLoop(start[mesh->size], all, all_places, &closed));
  PetscCallMPI(
      MPI_Scatterv(all_places, count, start, place_type, tail_at, count[mesh->rank], place_type, 0, mesh->comm));
  PetscCallMPI(MPI_Type_free(&edge_type));
  PetscCallMPI(MPI_Type_free(&place_type));
  if (mesh->rank == 0) PetscCall(PetscFree2(all, all_places));
  PetscCall(PetscFree2(count, start));
  PetscCallMPI(MPI_Bcast(&closed, 1, MPIU_BOOL, 0, mesh->comm));
  if (!closed)
    EqmFail(mesh->comm, EQM_ERR_MESH, "the boundary is not one closed loop; 'equimap check' says what is wrong");
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshBoundaryLoop(EqmMesh mesh, PetscInt *place, PetscReal *arc_length)
{
  const PetscInt num_facets = mesh->num_boundary_facets;
  PetscInt n = 0;
  PetscReal *both;
  LoopEdge *edge;
  LoopPlace *tail_at;

  PetscFunctionBegin;
  PetscCheck(mesh->cell_size == 3, mesh->comm, PETSC_ERR_ARG_WRONG, "only the boundary of a surface is a loop");
  PetscCall(PetscMalloc3(num_facets, &edge, num_facets, &tail_at, 2 * mesh->num_local, &both));
  for (PetscInt e = 0; e < num_facets; e++) {
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    const PetscReal *const p = mesh->position + 3 * i, *const q = mesh->position + 3 * j;
    if (i >= mesh->num_owned) continue;
    edge[n].tail = mesh->global[i];
    edge[n].head = mesh->global[j];
    edge[n].order = mesh->boundary_order[e];
    edge[n++].length = PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
  }
  PetscCall(OrderLoopOnRoot(mesh, n, edge, tail_at));
  for (PetscInt k = 0; k < 2 * mesh->num_local; k++) both[k] = -1.;
  for (PetscInt e = 0; e < n; e++) {
    const PetscInt i = edge[e].tail - mesh->vertex_start;
    both[2 * i] = (PetscReal)tail_at[e].place;
    both[2 * i + 1] = tail_at[e].arc;
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, both));
  for (PetscInt i = 0; i < mesh->num_local; i++) {
    place[i] = (PetscInt)both[2 * i];
    arc_length[i] = both[2 * i + 1];
  }
  PetscCall(PetscFree3(edge, tail_at, both));
  PetscFunctionReturn(0);
}
