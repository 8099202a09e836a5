#include "mesh/handles.h"
#include "mesh/soup_private.h"
#include "base/sets.h"
#include "base/sort.h"
#include <string.h>

enum { NUM_ROOTS = 4 };

typedef struct {
  PetscInt low, high, cell[2]; /* cell[1] is -1 on the boundary */
} Edge;

typedef struct {
  const EqmSerialMesh *mesh;
  PetscInt num_edges;
  Edge *edge;
  PetscInt *start, *around; /* the edges around each vertex */
  PetscInt *depth, *parent; /* breadth-first tree: hops from the root (-1: not reached), edge to the parent */
  PetscInt *set;            /* disjoint sets of cells, and behind them of vertices, which stand for boundary loops */
} Graph;

static int CompareEdges(const void *a, const void *b)
{
  const Edge *const s = a, *const t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  if (s->high != t->high) return s->high < t->high ? -1 : 1;
  return (s->cell[0] > t->cell[0]) - (s->cell[0] < t->cell[0]);
}

static PetscBool IsUsable(const EqmSerialMesh *mesh, PetscInt c)
{
  const PetscInt *const v = mesh->cells + 3 * c;

  for (int a = 0; a < 3; a++) {
    if (v[a] < 0 || v[a] >= mesh->num_vertices || v[a] == v[(a + 1) % 3]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The edges with their cells, ascending; none where some edge has more than two. */
static PetscErrorCode MakeEdges(Graph *graph)
{
  const EqmSerialMesh *const mesh = graph->mesh;
  PetscInt count = 0, kept = 0;
  Edge *const edge = graph->edge;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;

    for (int a = 0; a < 3 && IsUsable(mesh, c); a++) {
      const PetscInt p = v[a], q = v[(a + 1) % 3];
      edge[count++] = (Edge){PetscMin(p, q), PetscMax(p, q), {c, -1}};
    }
  }
  EqmSort(edge, (size_t)count, sizeof(Edge), CompareEdges);
  for (PetscInt k = 0; k < count; k++) {
    Edge *const last = kept ? &edge[kept - 1] : NULL;

    if (!last || last->low != edge[k].low || last->high != edge[k].high) {
      edge[kept++] = edge[k];
    } else if (last->cell[1] < 0) {
      last->cell[1] = edge[k].cell[0];
    } else {
      kept = 0; /* no manifold */
      break;
    }
  }
  graph->num_edges = kept;
  PetscFunctionReturn(0);
}

static PetscErrorCode GraphCreate(const EqmSerialMesh *mesh, Graph *graph)
{
  const PetscInt n = mesh->num_vertices;

  PetscFunctionBegin;
  *graph = (Graph){.mesh = mesh};
  PetscCall(PetscMalloc1(3 * mesh->num_cells, &graph->edge));
  PetscCall(MakeEdges(graph));
  PetscCall(PetscMalloc5(n + 2, &graph->start, 2 * graph->num_edges, &graph->around, n, &graph->depth, n,
                         &graph->parent, mesh->num_cells + n, &graph->set));
  PetscCall(PetscArrayzero(graph->start, n + 2));
  for (PetscInt e = 0; e < graph->num_edges; e++) {
    graph->start[graph->edge[e].low + 2]++;
    graph->start[graph->edge[e].high + 2]++;
  }
  for (PetscInt v = 0; v < n; v++) graph->start[v + 2] += graph->start[v + 1];
  for (PetscInt e = 0; e < graph->num_edges; e++) {
    graph->around[graph->start[graph->edge[e].low + 1]++] = e;
    graph->around[graph->start[graph->edge[e].high + 1]++] = e;
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode GraphReset(Graph *graph)
{
  PetscFunctionBegin;
  PetscCall(PetscFree5(graph->start, graph->around, graph->depth, graph->parent, graph->set));
  PetscCall(PetscFree(graph->edge));
  PetscFunctionReturn(0);
}

static PetscInt OtherEnd(const Graph *graph, PetscInt e, PetscInt v)
{
  return graph->edge[e].low == v ? graph->edge[e].high : graph->edge[e].low;
}

static PetscErrorCode GrowTree(Graph *graph, PetscInt root)
{
  PetscInt *queue, head = 0, tail = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(graph->mesh->num_vertices, &queue));
  for (PetscInt v = 0; v < graph->mesh->num_vertices; v++) graph->depth[v] = graph->parent[v] = -1;
  graph->depth[root] = 0;
  queue[tail++] = root;
  while (head < tail) {
    const PetscInt v = queue[head++];

    for (PetscInt k = graph->start[v]; k < graph->start[v + 1]; k++) {
      const PetscInt e = graph->around[k], w = OtherEnd(graph, e, v);

      if (graph->depth[w] >= 0) continue;
      graph->depth[w] = graph->depth[v] + 1;
      graph->parent[w] = e;
      queue[tail++] = w;
    }
  }
  PetscCall(PetscFree(queue));
  PetscFunctionReturn(0);
}

/* The edges that neither tree nor cotree has, two per handle. The cotree takes edges far from the root first: so the
   loops of those that are left are short. Boundary loops count as cells. */
static PetscErrorCode FindGenerators(Graph *graph, PetscInt *count, PetscInt **generator)
{
  const PetscInt num_cells = graph->mesh->num_cells;
  PetscInt *order, *key, num = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < num_cells + graph->mesh->num_vertices; i++) graph->set[i] = i;
  PetscCall(PetscMalloc2(graph->num_edges, &order, graph->num_edges, &key));
  for (PetscInt e = 0; e < graph->num_edges; e++) {
    const Edge *const edge = &graph->edge[e];

    if (edge->cell[1] < 0) (void)EqmSetJoin(graph->set, num_cells + edge->low, num_cells + edge->high);
    if (graph->depth[edge->low] < 0 || graph->parent[edge->low] == e || graph->parent[edge->high] == e) continue;
    key[num] = -(graph->depth[edge->low] + graph->depth[edge->high]);
    order[num++] = e;
  }
  PetscCall(PetscSortIntWithArray(num, key, order));
  *count = 0;
  for (PetscInt k = 0; k < num; k++) {
    const Edge *const edge = &graph->edge[order[k]];
    const PetscInt other = edge->cell[1] < 0 ? num_cells + edge->low : edge->cell[1];

    if (!EqmSetJoin(graph->set, edge->cell[0], other)) order[(*count)++] = order[k];
  }
  PetscCall(PetscMalloc1(*count, generator));
  PetscCall(PetscArraycpy(*generator, order, *count));
  PetscCall(PetscFree2(order, key));
  PetscFunctionReturn(0);
}

static PetscReal EdgeLength(const Graph *graph, PetscInt e)
{
  const PetscReal *const x = graph->mesh->vertices + 3 * graph->edge[e].low;
  const PetscReal *const y = graph->mesh->vertices + 3 * graph->edge[e].high;

  return PetscSqrtReal(PetscSqr(x[0] - y[0]) + PetscSqr(x[1] - y[1]) + PetscSqr(x[2] - y[2]));
}

/* The loop of an edge and the tree: its length, and if `loop` is given its vertices. */
static PetscReal Trace(const Graph *graph, PetscInt e, PetscInt *num, PetscInt *loop)
{
  PetscInt u = graph->edge[e].low, v = graph->edge[e].high, front = 0, back = 0;
  PetscReal length = EdgeLength(graph, e);

  /* from both ends towards the root until they meet; the way from v is written backwards behind */
  *num = 1;
  for (PetscInt a = u, b = v; a != b; (*num)++) {
    PetscInt *const deeper = graph->depth[a] >= graph->depth[b] ? &a : &b;
    length += EdgeLength(graph, graph->parent[*deeper]);
    *deeper = OtherEnd(graph, graph->parent[*deeper], *deeper);
  }
  if (!loop) return length;
  while (u != v) {
    if (graph->depth[u] >= graph->depth[v]) {
      loop[front++] = u;
      u = OtherEnd(graph, graph->parent[u], u);
    } else {
      loop[*num - ++back] = v;
      v = OtherEnd(graph, graph->parent[v], v);
    }
  }
  loop[front] = u;
  return length;
}

/* The shortest loop seen from a root; it replaces `loop` if it is shorter than `best`. */
static PetscErrorCode TryRoot(Graph *graph, PetscInt root, PetscReal *best, PetscInt *num, PetscInt **loop)
{
  PetscInt count, *generator, shortest = -1, length;

  PetscFunctionBegin;
  PetscCall(GrowTree(graph, root));
  PetscCall(FindGenerators(graph, &count, &generator));
  for (PetscInt k = 0; k < count; k++) {
    const PetscReal found = Trace(graph, generator[k], &length, NULL);

    if (found >= *best) continue;
    *best = found;
    shortest = generator[k];
    *num = length;
  }
  PetscCall(PetscFree(generator));
  if (shortest < 0) PetscFunctionReturn(0);
  PetscCall(PetscFree(*loop));
  PetscCall(PetscMalloc1(*num, loop));
  (void)Trace(graph, shortest, &length, *loop);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmHandleFind(const EqmSerialMesh *mesh, PetscInt *length, PetscInt **loop)
{
  PetscReal best = PETSC_MAX_REAL;
  Graph graph;

  PetscFunctionBegin;
  *length = 0;
  *loop = NULL;
  PetscCall(GraphCreate(mesh, &graph));
  for (PetscInt k = 0; k < NUM_ROOTS && graph.num_edges; k++) {
    /* from somewhere first, then from the loop that was found: its handle is near */
    if (k && !*length) break;
    PetscCall(
        TryRoot(&graph, k ? (*loop)[(k - 1) * *length / (NUM_ROOTS - 1)] : graph.edge[0].low, &best, length, loop));
  }
  PetscCall(GraphReset(&graph));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDiagnosisPlaceHandle(EqmSoup soup, EqmDiagnosis *diagnosis)
{
  EqmFinding *const finding = &diagnosis->finding[EQM_FINDING_GENUS];
  EqmSerialMesh mesh;
  PetscInt length = 0, *loop = NULL;
  PetscMPIInt rank;

  PetscFunctionBegin;
  if (soup->cell_size != 3 || diagnosis->genus <= 0 || soup->num_cells > EQM_MOST_CELLS_FOR_HANDLES)
    PetscFunctionReturn(0);
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(EqmSoupGather(soup, &mesh));
  if (rank == 0) PetscCall(EqmHandleFind(&mesh, &length, &loop));
  PetscCall(EqmSerialMeshReset(&mesh));
  for (PetscInt k = 0; k < 4 * EQM_FINDING_SHOWN; k++) finding->where[k / 4][k % 4] = k < length ? loop[k] : -1;
  finding->shown = PetscMin((length + 3) / 4, EQM_FINDING_SHOWN);
  PetscCall(PetscFree(loop));
  PetscCallMPI(MPI_Bcast(finding, (PetscMPIInt)sizeof(*finding), MPI_BYTE, 0, soup->comm));
  PetscFunctionReturn(0);
}
