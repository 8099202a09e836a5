/* Separators between the ranks' shares of a mesh, and the order in which a rank eliminates what is its own. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include "mesh/build.h"

/* Of every edge between two ranks the end on the lower rank is a separator: all rows of the unknowns left, as stored in
   the lower triangle, are then whole on their rank. */
static PetscErrorCode MarkSeparators(EqmMesh mesh, const EqmGraph *graph, PetscReal *is_separator)
{
  const PetscInt end = mesh->vertex_start + mesh->num_owned;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    is_separator[v] = 0.;
    for (PetscInt q = graph->start[v]; q < graph->start[v + 1]; q++) {
      if (mesh->global[graph->neighbor[q]] >= end) is_separator[v] = 1.;
    }
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, is_separator));
  PetscFunctionReturn(0);
}

/* Lowest and highest rank that has each local vertex, as owner or as ghost. */
static PetscErrorCode FindSpans(EqmMesh mesh, PetscInt *low, PetscInt *high)
{
  const PetscInt n = mesh->num_owned;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < mesh->num_local; v++) low[v] = high[v] = mesh->rank;
  if (mesh->size == 1) PetscFunctionReturn(0);
  PetscCall(PetscSFReduceBegin(mesh->halo, MPIU_INT, low + n, low, MPI_MIN));
  PetscCall(PetscSFReduceEnd(mesh->halo, MPIU_INT, low + n, low, MPI_MIN));
  PetscCall(PetscSFReduceBegin(mesh->halo, MPIU_INT, high + n, high, MPI_MAX));
  PetscCall(PetscSFReduceEnd(mesh->halo, MPIU_INT, high + n, high, MPI_MAX));
  PetscCall(PetscSFBcastBegin(mesh->halo, MPIU_INT, low, low + n, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, low, low + n, MPI_REPLACE));
  PetscCall(PetscSFBcastBegin(mesh->halo, MPIU_INT, high, high + n, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, high, high + n, MPI_REPLACE));
  PetscFunctionReturn(0);
}

/* List the separators: owned and ghost vertices by global number, that is ghosts of lower ranks, owned ones, the
   others. */
static PetscErrorCode ListSeparators(EqmMesh mesh, const EqmGraph *graph, const PetscReal *is_separator,
                                     EqmSeparation *s)
{
  PetscInt *low, *high, *local, *global, n = 0;

  PetscFunctionBegin;
  PetscCall(
      PetscMalloc4(mesh->num_local, &low, mesh->num_local, &high, mesh->num_local, &local, mesh->num_local, &global));
  PetscCall(FindSpans(mesh, low, high));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    if (is_separator[v] == 0.) continue;
    local[n] = v;
    global[n++] = mesh->global[v];
  }
  PetscCall(PetscSortIntWithArray(n, global, local));
  s->num_separators = n;
  PetscCall(PetscMalloc3(n, &s->vertex, 2 * n, &s->span, n, &s->links));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt v = s->vertex[k] = local[k];
    s->span[2 * k] = low[v];
    s->span[2 * k + 1] = high[v];
    s->links[k] = 1;
    for (PetscInt q = v < mesh->num_owned ? graph->start[v] : 0; v < mesh->num_owned && q < graph->start[v + 1]; q++)
      s->links[k] += is_separator[graph->neighbor[q]] != 0.;
  }
  PetscCall(PetscFree4(low, high, local, global));
  PetscFunctionReturn(0);
}

/* Nested dissection of the vertices that are left to this rank. */
static PetscErrorCode OrderInner(EqmMesh mesh, const EqmGraph *graph, const PetscReal *is_separator, EqmSeparation *s)
{
  PetscInt *vertex, *number, *degree, *neighbor, n = 0, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(mesh->num_owned, &vertex, mesh->num_owned, &number, mesh->num_owned + 1, &degree,
                         graph->start[mesh->num_owned], &neighbor));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    if (is_separator[v] != 0.) continue;
    number[v] = n;
    vertex[n++] = v;
  }
  for (PetscInt i = 0; i < n; i++) {
    degree[i] = 0;
    for (PetscInt q = graph->start[vertex[i]]; q < graph->start[vertex[i] + 1]; q++) {
      const PetscInt w = graph->neighbor[q];
      if (is_separator[w] != 0.) continue; /* the others that are no separators are this rank's */
      neighbor[count++] = number[w];
      degree[i]++;
    }
  }
  s->num_inner = n;
  PetscCall(PetscMalloc1(n, &s->inner));
  PetscCall(EqmDissect(n, degree, neighbor, s->inner));
  for (PetscInt k = 0; k < n; k++) s->inner[k] = vertex[s->inner[k]];
  PetscCall(PetscFree4(vertex, number, degree, neighbor));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmSeparationCreate(EqmMesh mesh, EqmSeparation **out)
{
  EqmSeparation *s;
  EqmGraph graph;
  PetscReal *is_separator;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  PetscCall(PetscMalloc1(mesh->num_local, &is_separator));
  PetscCall(EqmGraphOfCells(mesh->num_owned, mesh->cell_size, mesh->num_local_cells, mesh->cells, &graph));
  PetscCall(MarkSeparators(mesh, &graph, is_separator));
  PetscCall(ListSeparators(mesh, &graph, is_separator, s));
  PetscCall(OrderInner(mesh, &graph, is_separator, s));
  PetscCall(EqmGraphReset(&graph));
  PetscCall(PetscFree(is_separator));
  *out = s;
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmSeparationDestroy(EqmSeparation **s)
{
  PetscFunctionBegin;
  if (!*s) PetscFunctionReturn(0);
  PetscCall(PetscFree((*s)->inner));
  PetscCall(PetscFree3((*s)->vertex, (*s)->span, (*s)->links));
  PetscCall(PetscFree(*s));
  PetscFunctionReturn(0);
}
