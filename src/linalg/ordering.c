/* Nested dissection of the vertex graph. Ordering vertices, not unknowns, is four times cheaper, serves the scalar and
   the coupled matrices alike, and keeps the unknowns of a vertex together. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include "base/narrow.h"
#include "mesh/build.h"

struct _p_EqmOrdering {
  EqmMesh mesh;
  PetscInt *order; /* rank 0: the k-th vertex (global number) to eliminate; made at the first need */
  PetscBool ordered;
  EqmSeparation *separation; /* made at the first need */
};

static PetscErrorCode GatherInts(EqmMesh mesh, PetscInt n, const PetscInt *mine, PetscInt **all, PetscInt *num_all)
{
  PetscMPIInt *count, *start;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->size, &count, mesh->size + 1, &start));
  PetscCall(EqmGatherCounts(mesh->comm, n, "numbers gathered on one rank for its ordering", count, start));
  *num_all = start[mesh->size];
  *all = NULL;
  if (mesh->rank == 0) PetscCall(PetscMalloc1(*num_all + 1, all));
  PetscCallMPI(MPI_Gatherv(mine, count[mesh->rank], MPIU_INT, *all, count, start, MPIU_INT, 0, mesh->comm));
  PetscCall(PetscFree2(count, start));
  PetscFunctionReturn(0);
}

/* Order the vertices of the whole mesh. METIS is serial: the graph visits rank 0 for the time of the call. */
static PetscErrorCode OrderAll(EqmOrdering ordering)
{
  const EqmMesh mesh = ordering->mesh;
  EqmGraph graph;
  PetscInt *degree, *all_degrees, *all_neighbors, n, num_edges;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_PARTITION));
  PetscCall(EqmGraphOfCells(mesh->num_owned, mesh->cell_size, mesh->num_local_cells, mesh->cells, &graph));
  PetscCall(PetscMalloc1(mesh->num_owned, &degree));
  for (PetscInt i = 0; i < mesh->num_owned; i++) degree[i] = graph.start[i + 1] - graph.start[i];
  for (PetscInt q = 0; q < graph.start[mesh->num_owned]; q++) graph.neighbor[q] = mesh->global[graph.neighbor[q]];
  PetscCall(GatherInts(mesh, mesh->num_owned, degree, &all_degrees, &n));
  PetscCall(GatherInts(mesh, graph.start[mesh->num_owned], graph.neighbor, &all_neighbors, &num_edges));
  PetscCall(PetscFree(degree));
  PetscCall(EqmGraphReset(&graph));
  if (mesh->rank == 0) {
    PetscCall(PetscMalloc1(n, &ordering->order));
    PetscCall(EqmDissect(n, all_degrees, all_neighbors, ordering->order));
  }
  PetscCall(PetscFree(all_degrees));
  PetscCall(PetscFree(all_neighbors));
  ordering->ordered = PETSC_TRUE;
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_PARTITION));
  PetscFunctionReturn(0);
}

/* Orderings are computed on first use. Not collective. */
PetscErrorCode EqmOrderingCreate(EqmMesh mesh, EqmOrdering *out)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(out));
  (*out)->mesh = mesh;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmOrderingGetSeparation(EqmOrdering ordering, const EqmSeparation **separation)
{
  PetscFunctionBegin;
  PetscCall(EqmEventBegin(ordering->mesh->ledger, EQM_EVENT_PARTITION));
  if (!ordering->separation) PetscCall(EqmSeparationCreate(ordering->mesh, &ordering->separation));
  PetscCall(EqmEventEnd(ordering->mesh->ledger, EQM_EVENT_PARTITION));
  *separation = ordering->separation;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmOrderingDestroy(EqmOrdering *ordering)
{
  PetscFunctionBegin;
  if (!*ordering) PetscFunctionReturn(0);
  PetscCall(PetscFree((*ordering)->order));
  PetscCall(EqmSeparationDestroy(&(*ordering)->separation));
  PetscCall(PetscFree(*ordering));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmOrderingOfUnknowns(EqmOrdering ordering, const EqmUnknowns *unknowns, PetscInt **position)
{
  const EqmMesh mesh = ordering->mesh;
  PetscInt *pair, *all, num_all;

  PetscFunctionBegin;
  if (!ordering->ordered) PetscCall(OrderAll(ordering));
  PetscCall(PetscMalloc1(2 * mesh->num_owned, &pair));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    pair[2 * v] = unknowns->start[v];
    pair[2 * v + 1] = unknowns->count[v];
  }
  PetscCall(GatherInts(mesh, 2 * mesh->num_owned, pair, &all, &num_all));
  PetscCall(PetscFree(pair));
  *position = NULL;
  if (mesh->rank == 0) {
    PetscInt num_unknowns = 0, next = 0;
    for (PetscInt v = 0; v < num_all / 2; v++) num_unknowns += all[2 * v + 1];
    PetscCall(PetscMalloc1(num_unknowns, position));
    for (PetscInt k = 0; k < num_all / 2; k++) {
      const PetscInt v = ordering->order[k];
      for (PetscInt d = 0; d < all[2 * v + 1]; d++) (*position)[all[2 * v] + d] = next++;
    }
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(0);
}
