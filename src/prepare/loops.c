/* Boundary loops, which are short, on one rank. */
#include "prepare/loops.h"
#include "base/exchange.h"
#include "base/sort.h"

static int CompareTails(const void *a, const void *b)
{
  const EqmBoundaryEdge *const s = a, *const t = b;
  return (s->tail > t->tail) - (s->tail < t->tail);
}

/* Gather the boundary edges, with the surface on their left, and the chords. */
PetscErrorCode EqmBoundaryGather(const EqmVicinity *vicinity, EqmBoundary *boundary)
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
  EqmSort(boundary->edge, (size_t)boundary->num_edges, sizeof(*boundary->edge), CompareTails);
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(chord));
  PetscCall(PetscFree2(on_boundary, edge));
  PetscFunctionReturn(0);
}

/* The place of a vertex among the edges' tails, or -1. */
static PetscInt FindTail(const EqmBoundary *boundary, PetscInt vertex)
{
  const EqmBoundaryEdge key = {.tail = vertex};
  const EqmBoundaryEdge *const found =
      EqmSearch(&key, boundary->edge, (size_t)boundary->num_edges, sizeof(key), CompareTails);

  return found ? (PetscInt)(found - boundary->edge) : -1;
}

/* Chain the edges to loops, from the lowest vertex of each on; chains that do not close are no loops. Not collective.
 */
PetscErrorCode EqmBoundaryChain(EqmBoundary *boundary)
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
PetscInt EqmBoundaryLongestLoop(const EqmBoundary *boundary)
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
static PetscInt FindSamePlace(const EqmBoundary *boundary, PetscInt depth, const PetscInt *stack, PetscInt e)
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
PetscErrorCode EqmBoundaryCutLoops(PetscInt open, EqmBoundary *boundary)
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
PetscErrorCode EqmBoundaryChords(const EqmBoundary *boundary, PetscInt n, const PetscInt *loop, PetscInt *place,
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
  EqmSort(chord, (size_t)*num_chords, sizeof(*chord), EqmComparePairs);
  for (PetscInt k = 0; k < n; k++) place[boundary->same[loop[k]]] = -1;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBoundaryReset(EqmBoundary *boundary)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(boundary->edge));
  PetscCall(PetscFree(boundary->chord));
  PetscCall(PetscFree(boundary->same));
  PetscCall(PetscFree2(boundary->order, boundary->loop_start));
  PetscFunctionReturn(0);
}
