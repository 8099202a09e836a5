/* Fill holes: boundary loops, which are short, are gathered on one rank and filled there one by one. */
#include "prepare/step.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "mesh/target.h"

/* The boundary on rank 0. */
typedef struct {
  PetscInt num_edges, num_chords, num_loops;
  EqmBoundaryEdge *edge; /* ascending by tail */
  PetscInt (*chord)[2];  /* interior edges between boundary vertices, places of their ends in `edge`, ascending */
  PetscInt *order;       /* the edges along the loops */
  PetscInt *loop_start;  /* num_loops + 1, in `order` */
  PetscInt *same;        /* per edge the one whose tail its tail is, once loops are cut where they touch themselves */
} Boundary;

static int CompareTails(const void *a, const void *b)
{
  const EqmBoundaryEdge *const s = a, *const t = b;
  return (s->tail > t->tail) - (s->tail < t->tail);
}

/* Gather the boundary edges, with the surface on their left, and the chords. */
static PetscErrorCode GatherBoundary(const EqmVicinity *vicinity, Boundary *boundary)
{
  PetscInt num_edges = 0, num_chords = 0, capacity = 64;
  PetscBool *on_boundary;
  PetscMPIInt *destination;
  PetscInt *chord;
  EqmBoundaryEdge *edge;
  EqmLink link;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(vicinity->num_local, &on_boundary, vicinity->num_owned, &edge));
  PetscCall(PetscMemzero(edge, (size_t)vicinity->num_owned * sizeof(*edge)));
  PetscCall(PetscMalloc1(2 * capacity, &chord));
  PetscCall(EqmVicinityMarkBoundary(vicinity, on_boundary));
  PetscCall(EqmLinkCreate(vicinity, &link));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    PetscBool has_edge = PETSC_FALSE;

    if (!on_boundary[v]) continue;
    EqmLinkCompute(vicinity, v, &link);
    for (PetscInt i = 0; i < link.num_vertices; i++) {
      const PetscInt w = link.vertex[i];

      if (link.on_boundary[i] && link.leaving[i] == 1 && !has_edge) {
        edge[num_edges].tail = vicinity->input[v];
        edge[num_edges].head = vicinity->input[w];
        PetscCall(PetscArraycpy(edge[num_edges++].x, vicinity->position + 3 * v, 3));
        has_edge = PETSC_TRUE;
      }
      if (link.on_boundary[i] || !on_boundary[w] || vicinity->input[w] < vicinity->input[v]) continue;
      if (num_chords == capacity) {
        capacity *= 2;
        PetscCall(PetscRealloc((size_t)(2 * capacity) * sizeof(PetscInt), &chord));
      }
      chord[2 * num_chords] = vicinity->input[v];
      chord[2 * num_chords++ + 1] = vicinity->input[w];
    }
  }
  PetscCall(EqmLinkReset(&link));
  PetscCall(PetscCalloc1(PetscMax(num_edges, num_chords), &destination));
  PetscCall(EqmExchangeBytes(vicinity->comm, num_edges, sizeof(*edge), destination, edge, &boundary->num_edges,
                             &boundary->edge));
  PetscCall(EqmExchange(vicinity->comm, num_chords, 2, destination, chord, &boundary->num_chords,
                        (PetscInt **)&boundary->chord));
  qsort(boundary->edge, (size_t)boundary->num_edges, sizeof(*boundary->edge), CompareTails);
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(chord));
  PetscCall(PetscFree2(on_boundary, edge));
  PetscFunctionReturn(0);
}

/* The place of a vertex among the edges' tails, or -1. */
static PetscInt FindTail(const Boundary *boundary, PetscInt vertex)
{
  const EqmBoundaryEdge key = {.tail = vertex};
  const EqmBoundaryEdge *const found =
      bsearch(&key, boundary->edge, (size_t)boundary->num_edges, sizeof(key), CompareTails);

  return found ? (PetscInt)(found - boundary->edge) : -1;
}

/* Chain the edges to loops, from the lowest vertex of each on; chains that do not close are no loops. Not collective.
 */
static PetscErrorCode ChainLoops(Boundary *boundary)
{
  const PetscInt n = boundary->num_edges;
  PetscInt count = 0;
  PetscBool *used;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n, &used));
  PetscCall(PetscMalloc2(n, &boundary->order, n + 1, &boundary->loop_start));
  boundary->num_loops = 0;
  boundary->loop_start[0] = 0;
  for (PetscInt first = 0; first < n; first++) {
    PetscInt e = first;

    if (used[first]) continue;
    for (; e >= 0 && !used[e]; e = FindTail(boundary, boundary->edge[e].head)) {
      used[e] = PETSC_TRUE;
      boundary->order[count++] = e;
    }
    if (e == first)
      boundary->loop_start[++boundary->num_loops] = count;
    else
      count = boundary->loop_start[boundary->num_loops];
  }
  for (PetscInt k = 0; k < boundary->num_chords; k++) {
    for (int a = 0; a < 2; a++) boundary->chord[k][a] = FindTail(boundary, boundary->chord[k][a]);
  }
  PetscCall(PetscFree(used));
  PetscFunctionReturn(0);
}

/* The longest loop, which stays open. */
static PetscInt LongestLoop(const Boundary *boundary)
{
  PetscReal longest = -1.;
  PetscInt best = -1;

  for (PetscInt l = 0; l < boundary->num_loops; l++) {
    const PetscInt start = boundary->loop_start[l], n = boundary->loop_start[l + 1] - start;
    PetscReal length = 0.;

    for (PetscInt k = 0; k < n; k++) {
      const PetscReal *const x = boundary->edge[boundary->order[start + k]].x;
      const PetscReal *const y = boundary->edge[boundary->order[start + (k + 1) % n]].x;
      length += PetscSqrtReal(PetscSqr(x[0] - y[0]) + PetscSqr(x[1] - y[1]) + PetscSqr(x[2] - y[2]));
    }
    if (length <= longest) continue;
    longest = length;
    best = l;
  }
  return best;
}

/* The place on the stack of an edge whose tail lies where that of edge e lies, or -1. */
static PetscInt FindSamePlace(const Boundary *boundary, PetscInt depth, const PetscInt *stack, PetscInt e)
{
  const PetscReal *const x = boundary->edge[e].x;

  for (PetscInt k = 0; k < depth; k++) {
    const PetscReal *const y = boundary->edge[stack[k]].x;
    if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) return k;
  }
  return -1;
}

/* Split loops that pass the same position twice, as around a vertex that was cut apart between two holes, into simple
   loops. Their copies of that vertex are joined, as between two fillings it is a regular vertex. The loop `open` is not
   changed. Not collective. */
static PetscErrorCode CutLoops(PetscInt open, Boundary *boundary)
{
  const PetscInt n = boundary->num_edges;
  PetscInt *stack, *order, *start, count = 0, num_loops = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &boundary->same));
  PetscCall(PetscMalloc1(n, &stack));
  PetscCall(PetscMalloc2(n, &order, n + 1, &start));
  for (PetscInt e = 0; e < n; e++) boundary->same[e] = e;
  start[0] = 0;
  for (PetscInt l = 0; l < boundary->num_loops; l++) {
    PetscInt depth = 0;

    for (PetscInt k = boundary->loop_start[l]; l != open && k < boundary->loop_start[l + 1]; k++) {
      const PetscInt e = boundary->order[k], found = FindSamePlace(boundary, depth, stack, e);

      if (found >= 0) {
        boundary->same[e] = boundary->same[stack[found]];
        for (PetscInt i = found; i < depth; i++) order[count++] = stack[i];
        start[++num_loops] = count;
        depth = found;
      }
      stack[depth++] = e;
    }
    for (PetscInt i = 0; i < depth; i++) order[count++] = stack[i];
    if (depth) start[++num_loops] = count;
  }
  PetscCall(PetscFree(stack));
  PetscCall(PetscFree2(boundary->order, boundary->loop_start));
  boundary->order = order;
  boundary->loop_start = start;
  boundary->num_loops = num_loops;
  PetscFunctionReturn(0);
}

/* The chords of one loop as pairs of places in it. `place` is scratch, -1 per edge. */
static PetscErrorCode ChordsOfLoop(const Boundary *boundary, PetscInt n, const PetscInt *loop, PetscInt *place,
                                   PetscInt *num_chords, PetscInt (*chord)[2])
{
  PetscFunctionBegin;
  *num_chords = 0;
  for (PetscInt k = 0; k < n; k++) place[boundary->same[loop[k]]] = k;
  for (PetscInt k = 0; k < boundary->num_chords; k++) {
    PetscInt ends[2] = {boundary->chord[k][0], boundary->chord[k][1]};

    if (ends[0] < 0 || ends[1] < 0) continue;
    for (int a = 0; a < 2; a++) ends[a] = boundary->same[ends[a]];
    if (place[ends[0]] < 0 || place[ends[1]] < 0) continue;
    chord[*num_chords][0] = PetscMin(place[ends[0]], place[ends[1]]);
    chord[(*num_chords)++][1] = PetscMax(place[ends[0]], place[ends[1]]);
  }
  qsort(chord, (size_t)*num_chords, sizeof(*chord), EqmComparePairs);
  for (PetscInt k = 0; k < n; k++) place[boundary->same[loop[k]]] = -1;
  PetscFunctionReturn(0);
}

/* Fill one loop: its triangles go to the list, its new vertices to the group. The hole is on the left of the loop
   backwards. */
static PetscErrorCode FillLoop(const Boundary *boundary, PetscInt l, PetscInt num_kept, PetscInt *place,
                               PetscInt (*chord)[2], EqmVertexGroup *group, EqmCellList *list)
{
  const PetscInt start = boundary->loop_start[l], n = boundary->loop_start[l + 1] - start;
  PetscInt *loop, num_chords, num_added;
  PetscReal *position;
  EqmPatch patch;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &loop, 3 * n, &position));
  for (PetscInt k = 0; k < n; k++) {
    loop[k] = boundary->order[start + n - 1 - k];
    PetscCall(PetscArraycpy(position + 3 * k, boundary->edge[loop[k]].x, 3));
  }
  PetscCall(ChordsOfLoop(boundary, n, loop, place, &num_chords, chord));
  PetscCall(EqmPatchCreate(n, position, num_chords, (const PetscInt(*)[2])chord, &patch));
  PetscCall(EqmPatchRefine(num_chords, (const PetscInt(*)[2])chord, &patch));
  num_added = patch.num_vertices - n;
  PetscCall(PetscRealloc((size_t)(3 * (group->num_local + num_added)) * sizeof(PetscReal), &group->position));
  PetscCall(PetscArraycpy(group->position + 3 * group->num_local, patch.position + 3 * n, 3 * num_added));
  for (PetscInt t = 0; t < patch.num_triangles; t++) {
    PetscInt vertex[3];

    for (int a = 0; a < 3; a++) {
      const PetscInt v = patch.triangle[3 * t + a];
      vertex[a] = v < n ? boundary->edge[boundary->same[loop[v]]].tail : num_kept + group->num_local + v - n;
    }
    PetscCall(EqmCellListAdd(list, -1, vertex));
  }
  group->num_local += num_added;
  PetscCall(EqmPatchReset(&patch));
  PetscCall(PetscFree2(loop, position));
  PetscFunctionReturn(0);
}

/* Fill the loops that rank 0 has; on the others there are none. */
static PetscErrorCode FillLoops(PetscBool all, PetscInt num_kept, Boundary *boundary, EqmVertexGroup *group,
                                EqmCellList *list, PetscInt64 *filled)
{
  PetscInt *place, (*chord)[2];

  PetscFunctionBegin;
  PetscCall(CutLoops(all ? -1 : LongestLoop(boundary), boundary));
  PetscCall(PetscMalloc2(boundary->num_edges, &place, boundary->num_chords, &chord));
  for (PetscInt e = 0; e < boundary->num_edges; e++) place[e] = -1;
  for (PetscInt l = 0; l < boundary->num_loops; l++) {
    PetscCall(FillLoop(boundary, l, num_kept, place, chord, group, list));
    ++*filled;
  }
  PetscCall(PetscFree2(place, chord));
  PetscFunctionReturn(0);
}

/* Share the joined vertices with all ranks: number[i] was joined to other[i], ascending. They are few. */
static PetscErrorCode ShareJoined(MPI_Comm comm, const Boundary *boundary, PetscInt *num_joined, PetscInt **number,
                                  PetscInt **other)
{
  PetscInt count = 0;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < boundary->num_edges; e++) count += boundary->same[e] != e;
  PetscCallMPI(MPI_Bcast(&count, 1, MPIU_INT, 0, comm));
  PetscCall(PetscMalloc2(count, number, count, other));
  for (PetscInt e = 0, k = 0; e < boundary->num_edges; e++) { /* ascending by tail */
    if (boundary->same[e] == e) continue;
    (*number)[k] = boundary->edge[e].tail;
    (*other)[k++] = boundary->edge[boundary->same[e]].tail;
  }
  PetscCallMPI(MPI_Bcast(*number, (PetscMPIInt)count, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(*other, (PetscMPIInt)count, MPIU_INT, 0, comm));
  *num_joined = count;
  PetscFunctionReturn(0);
}

/* List all cells of the mesh, with the numbers of joined vertices replaced. */
static PetscErrorCode KeepCells(const Boundary *boundary, EqmChange *change, EqmCellList *list)
{
  const EqmSoup soup = change->soup;
  PetscInt num_joined, *number, *other;

  PetscFunctionBegin;
  PetscCall(ShareJoined(soup->comm, boundary, &num_joined, &number, &other));
  for (PetscInt c = soup->cell_start; c < soup->cell_end; c++) {
    PetscInt vertex[3];

    for (PetscInt a = 0; a < 3; a++) {
      PetscInt k;
      vertex[a] = soup->cells[3 * (c - soup->cell_start) + a];
      PetscCall(PetscFindInt(vertex[a], num_joined, number, &k));
      if (k >= 0) vertex[a] = other[k];
    }
    PetscCall(EqmCellListAdd(list, c, vertex));
  }
  change->renumbers = (PetscBool)(num_joined > 0);
  PetscCall(PetscMalloc1(soup->vertex_end - soup->vertex_start, &change->vertex));
  for (PetscInt v = soup->vertex_start; v < soup->vertex_end && num_joined; v++) {
    PetscInt k;
    PetscCall(PetscFindInt(v, num_joined, number, &k));
    change->vertex[v - soup->vertex_start] = k >= 0 ? other[k] : v;
  }
  PetscCall(PetscFree2(number, other));
  PetscFunctionReturn(0);
}

/* The cells that fill holes weigh `weight` times their area. */
static PetscErrorCode WeighFilling(EqmSoup soup, const PetscInt *parent, PetscReal weight)
{
  const PetscInt num_cells = soup->cell_end - soup->cell_start;

  PetscFunctionBegin;
  if (weight == 1.) PetscFunctionReturn(0);
  if (!soup->density) {
    PetscCall(PetscMalloc1(num_cells + 1, &soup->density));
    for (PetscInt c = 0; c < num_cells; c++) soup->density[c] = 1.;
  }
  for (PetscInt c = 0; c < num_cells; c++) {
    if (parent[c] < 0) soup->density[c] = weight;
  }
  PetscFunctionReturn(0);
}

/* `count` is of loops. All are filled for a target that takes closed surfaces only, else all but the longest. */
PetscErrorCode EqmStepHoles(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report)
{
  const EqmTarget *const target = options->target ? EqmTargetFind(options->target) : NULL;
  const PetscBool all = (PetscBool)(target && !target->domain[EQM_TOPOLOGY_DISK]);
  const PetscInt num_kept = change->soup->num_vertices;
  EqmVicinity vicinity;
  EqmVertexGroup group = {0};
  EqmCellList list = {.cell_size = 3};
  Boundary boundary = {0};
  PetscInt64 count[3] = {0, 0, 0}; /* loops, triangles, vertices */

  PetscFunctionBegin;
  if (change->soup->cell_size != 3) PetscFunctionReturn(0);
  PetscCall(EqmVicinityCreate(change->soup, &vicinity));
  PetscCall(GatherBoundary(&vicinity, &boundary));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscCall(ChainLoops(&boundary));
  PetscCall(FillLoops(all, num_kept, &boundary, &group, &list, &count[0]));
  count[1] = list.count;
  count[2] = group.num_local;
  PetscCallMPI(MPI_Bcast(count, 3, MPIU_INT64, 0, change->soup->comm));
  report->count = count[0];
  if (count[0]) {
    PetscCall(KeepCells(&boundary, change, &list));
    PetscCall(PetscSNPrintf(report->what, sizeof(report->what),
                            "%" PetscInt64_FMT " filled with %" PetscInt64_FMT " triangles and %" PetscInt64_FMT
                            " new vertices",
                            count[0], count[1], count[2]));
    PetscCall(EqmChangeAssemble(change, &group, &list));
    PetscCall(WeighFilling(change->soup, change->parent, options->hole_weight));
  }
  PetscCall(PetscFree(group.position));
  PetscCall(PetscFree(boundary.edge));
  PetscCall(PetscFree(boundary.chord));
  PetscCall(PetscFree(boundary.same));
  PetscCall(PetscFree2(boundary.order, boundary.loop_start));
  PetscFunctionReturn(0);
}
