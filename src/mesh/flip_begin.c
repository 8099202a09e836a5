/* Before the first flip: triangles by the lengths of their edges, and edges with numbers of their own. */
#include "mesh/flip.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "base/sort.h"

typedef struct {
  PetscInt low, high, rank, triangle, corner;
} HalfEdge;

/* Lengths of the cells' edges, from the vertices' places in the slabs. */
PetscErrorCode EqmFlipperMakeTriangles(EqmSoup soup, EqmFlipper *f)
{
  const PetscInt n = f->num_triangles;
  PetscReal *place;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &f->triangle, n, &f->changed, n, &f->claimed));
  PetscCall(PetscMalloc1(9 * n, &place));
  PetscCall(EqmFetchRows(soup->comm, soup->vertex_end - soup->vertex_start, 3 * n, soup->cells, MPIU_REAL, 3,
                         soup->vertices, place));
  for (PetscInt t = 0; t < n; t++) {
    for (PetscInt a = 0; a < 3; a++) {
      const PetscReal *const p = place + 9 * t + 3 * ((a + 1) % 3), *const q = place + 9 * t + 3 * ((a + 2) % 3);
      f->triangle[t].vertex[a] = soup->cells[3 * t + a];
      f->triangle[t].length[a] = PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]));
    }
    f->changed[t] = PETSC_TRUE;
  }
  PetscCall(PetscFree(place));
  PetscFunctionReturn(0);
}

static int CompareHalfEdges(const void *a, const void *b)
{
  const HalfEdge *const s = a, *const t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  return (s->high > t->high) - (s->high < t->high);
}

/* Number the edges, and enter the numbers into their triangles. */
PetscErrorCode EqmFlipperNumberEdges(EqmFlipper *f)
{
  const PetscInt n = 3 * f->num_triangles;
  PetscInt num_received, num_names;
  PetscMPIInt *destination;
  HalfEdge *half, *received;
  EqmEdgeId *name, *names;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &half, n, &destination));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt *const v = f->triangle[k / 3].vertex, p = v[(k + 1) % 3], q = v[(k + 2) % 3];
    half[k] = (HalfEdge){PetscMin(p, q), PetscMax(p, q), f->rank, k / 3, k % 3};
    destination[k] = (PetscMPIInt)(half[k].low % f->size);
  }
  PetscCall(EqmExchangeBytes(f->comm, n, sizeof(*half), destination, half, &num_received, &received));
  PetscCall(PetscFree2(half, destination));
  EqmSort(received, (size_t)num_received, sizeof(HalfEdge), CompareHalfEdges);
  PetscCall(PetscMalloc2(num_received, &name, num_received, &destination));
  for (PetscInt k = 0; k < num_received; k++) {
    if (k == 0 || CompareHalfEdges(&received[k], &received[k - 1])) f->num_edges++;
    name[k] = (EqmEdgeId){received[k].triangle, received[k].corner, f->size * (f->num_edges - 1) + f->rank};
    destination[k] = (PetscMPIInt)received[k].rank;
  }
  PetscCall(PetscFree(received));
  PetscCall(EqmExchangeBytes(f->comm, num_received, sizeof(*name), destination, name, &num_names, &names));
  for (PetscInt k = 0; k < num_names; k++) f->triangle[names[k].triangle].edge[names[k].corner] = names[k].edge;
  PetscCall(PetscFree(names));
  PetscCall(PetscFree2(name, destination));
  PetscCall(PetscCalloc1(f->num_edges, &f->edge));
  PetscFunctionReturn(0);
}
