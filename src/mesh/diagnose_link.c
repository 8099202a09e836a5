/* The link of a vertex: is its star one fan, one full turn, one ball? */
#include "mesh/diagnose.h"
#include "base/sets.h"

/* Work space for the links of all owned vertices of a vicinity. Free with EqmLinkReset. Not collective. */
PetscErrorCode EqmLinkCreate(const EqmVicinity *vicinity, EqmLink *link)
{
  PetscInt largest = 0, n;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(link, sizeof(*link)));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    largest = PetscMax(largest, vicinity->star_start[v + 1] - vicinity->star_start[v]);
  }
  n = 3 * largest;
  PetscCall(PetscMalloc6(n, &link->vertex, n, &link->leaving, n, &link->entering, 2 * n, &link->edge_cell, n,
                         &link->on_boundary, n, &link->vertex_root));
  PetscCall(PetscMalloc6(2 * n, &link->edge, n, &link->edge_count, n, &link->corner_root, 2 * n, &link->edge_corner, n,
                         &link->edge_head, n, &link->edge_next));
  PetscCall(PetscMalloc2(n, &link->edge_sides, vicinity->num_local, &link->place));
  for (PetscInt v = 0; v < vicinity->num_local; v++) link->place[v] = -1;
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmLinkReset(EqmLink *link)
{
  PetscFunctionBegin;
  PetscCall(
      PetscFree6(link->vertex, link->leaving, link->entering, link->edge_cell, link->on_boundary, link->vertex_root));
  PetscCall(
      PetscFree6(link->edge, link->edge_count, link->corner_root, link->edge_corner, link->edge_head, link->edge_next));
  PetscCall(PetscFree2(link->edge_sides, link->place));
  PetscFunctionReturn(0);
}

static PetscInt Place(EqmLink *link, PetscInt vertex)
{
  if (link->place[vertex] < 0) {
    const PetscInt i = link->num_vertices++;

    link->place[vertex] = i;
    link->vertex[i] = vertex;
    link->vertex_root[i] = i;
    link->leaving[i] = link->entering[i] = 0;
    link->edge_head[i] = -1;
    link->on_boundary[i] = PETSC_FALSE;
  }
  return link->place[vertex];
}

static void NoteEdgeCell(EqmLink *link, PetscInt i, PetscInt cell)
{
  const PetscInt seen = link->leaving[i] + link->entering[i];

  if (seen < 2) link->edge_cell[2 * i + seen] = cell;
}

static void LinkOfTriangles(const EqmVicinity *vicinity, PetscInt vertex, EqmLink *link)
{
  PetscInt pieces = 0;

  for (PetscInt s = vicinity->star_start[vertex]; s < vicinity->star_start[vertex + 1]; s++) {
    const PetscInt cell = vicinity->star[s], *const corner = vicinity->cells + 3 * cell;
    const int k = corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2;
    const PetscInt next = Place(link, corner[(k + 1) % 3]), previous = Place(link, corner[(k + 2) % 3]);

    NoteEdgeCell(link, next, cell);
    link->leaving[next]++;
    NoteEdgeCell(link, previous, cell);
    link->entering[previous]++;
    pieces -= EqmSetJoin(link->vertex_root, next, previous);
  }
  pieces += link->num_vertices;
  for (PetscInt i = 0; i < link->num_vertices; i++) {
    const PetscInt cells = link->leaving[i] + link->entering[i];

    link->on_boundary[i] = (PetscBool)(cells == 1);
    if (cells > 2) link->manifold = PETSC_FALSE;
  }
  link->regular = (PetscBool)(link->manifold && pieces == 1);
}

/* Enter the edge between the places a and b of the link's triangle that has the corners `corner_a`, `corner_b` there;
   the corners at an end of an edge of two triangles are one and the same fan. `turn` is how the triangle turns, seen
   from outside. Returns how many fans this joins. */
static PetscInt EnterLinkEdge(EqmLink *link, PetscInt a, PetscInt corner_a, PetscInt b, PetscInt corner_b,
                              PetscInt turn)
{
  const PetscInt low = PetscMin(a, b), high = PetscMax(a, b), side = a < b ? turn : -turn;
  const PetscInt corner_low = a < b ? corner_a : corner_b, corner_high = a < b ? corner_b : corner_a;
  PetscInt e;

  for (e = link->edge_head[low]; e >= 0 && link->edge[2 * e + 1] != high; e = link->edge_next[e]) continue;
  if (e >= 0) {
    link->edge_count[e]++;
    link->edge_sides[e] += side;
    return EqmSetJoin(link->corner_root, link->edge_corner[2 * e], corner_low) +
           EqmSetJoin(link->corner_root, link->edge_corner[2 * e + 1], corner_high);
  }
  e = link->num_edges++;
  link->edge[2 * e] = low;
  link->edge[2 * e + 1] = high;
  link->edge_count[e] = 1;
  link->edge_sides[e] = side;
  link->edge_corner[2 * e] = corner_low;
  link->edge_corner[2 * e + 1] = corner_high;
  link->edge_next[e] = link->edge_head[low];
  link->edge_head[low] = e;
  return 0;
}

static void LinkOfTetrahedra(const EqmVicinity *vicinity, PetscInt vertex, EqmLink *link)
{
  const PetscInt num_triangles = vicinity->star_start[vertex + 1] - vicinity->star_start[vertex];
  PetscInt pieces = 0, fans = 3 * num_triangles, num_boundary = 0, euler;

  for (PetscInt t = 0; t < num_triangles; t++) {
    const PetscInt cell = vicinity->star[vicinity->star_start[vertex] + t], *const corner = vicinity->cells + 4 * cell;
    PetscInt place[3], n = 0, turn = vicinity->side[cell];

    for (int k = 0; k < 4; k++) {
      if (corner[k] != vertex)
        place[n++] = Place(link, corner[k]);
      else if (k % 2)
        turn = -turn;
    }
    for (PetscInt k = 0; k < 3; k++) link->corner_root[3 * t + k] = 3 * t + k;
    for (PetscInt k = 0; k < 3; k++) {
      const PetscInt l = (k + 1) % 3;

      fans -= EnterLinkEdge(link, place[k], 3 * t + k, place[l], 3 * t + l, turn);
      pieces -= EqmSetJoin(link->vertex_root, place[k], place[l]);
    }
  }
  pieces += link->num_vertices;
  for (PetscInt e = 0; e < link->num_edges; e++) {
    if (link->edge_count[e] > 2) link->manifold = PETSC_FALSE;
    if (link->edge_count[e] != 1) continue;
    num_boundary++;
    link->on_boundary[link->edge[2 * e]] = link->on_boundary[link->edge[2 * e + 1]] = PETSC_TRUE;
  }
  /* one piece, one fan at each of its vertices, and the Euler characteristic of a sphere or a disk */
  euler = link->num_vertices - link->num_edges + num_triangles;
  link->regular =
      (PetscBool)(link->manifold && pieces == 1 && fans == link->num_vertices && euler == (num_boundary ? 1 : 2));
}

/* Compute the link of an owned vertex. A vertex without cells has an empty, regular link. Not collective. */
void EqmLinkCompute(const EqmVicinity *vicinity, PetscInt vertex, EqmLink *link)
{
  for (PetscInt i = 0; i < link->num_vertices; i++) link->place[link->vertex[i]] = -1;
  link->num_vertices = link->num_edges = 0;
  link->manifold = link->regular = PETSC_TRUE;
  if (vicinity->star_start[vertex] == vicinity->star_start[vertex + 1]) return;
  if (vicinity->cell_size == 3)
    LinkOfTriangles(vicinity, vertex, link);
  else
    LinkOfTetrahedra(vicinity, vertex, link);
}
