/* The intrinsic Delaunay triangulation of a surface: same vertices, same metric, edges flipped until no two angles that
   face each other add up to more than pi, so that no cotangent weight is negative (Bobenko and Springborn 2007). Edges
   become geodesics across the old triangles: they are known by their lengths alone, and two of them may join the same
   vertices.

   Every triangle belongs to the rank that has its cell, every edge to one rank. In a round, triangles that have changed
   are sent to their edges; edges that are not Delaunay request both their triangles; a triangle approves one request;
   edges with two approvals flip. */
#include "mesh/flip.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "geometry/simplex.h"

typedef struct {
  PetscInt triangle, unused; /* no gap, whose bytes would travel undefined */
  EqmFlipTriangle shape;
} Update;

/* Cotangent at a corner. */
static PetscReal Cotangent(const EqmFlipTriangle *t, PetscInt corner)
{
  const PetscReal a = t->length[corner], b = t->length[(corner + 1) % 3], c = t->length[(corner + 2) % 3];

  return .25 * (b * b + c * c - a * a) / PetscMax(EqmAreaOfLengths(t->length), PETSC_MACHINE_EPSILON * a * a);
}

static PetscInt Mix(PetscInt edge)
{
  return (PetscInt)(((unsigned)edge * 2654435761u) >> 1);
}

/* Triangles that have changed are sent to the ranks of their edges. */
static PetscErrorCode SendTrianglesToEdges(EqmFlipper *f)
{
  PetscInt count = 0, num_received;
  PetscMPIInt *destination;
  EqmFlipSide *side, *received;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < f->num_triangles; t++) count += f->changed[t] ? 3 : 0;
  PetscCall(PetscMalloc2(count, &side, count, &destination));
  count = 0;
  for (PetscInt t = 0; t < f->num_triangles; t++) {
    for (PetscInt a = 0; a < 3 && f->changed[t]; a++) {
      destination[count] = (PetscMPIInt)(f->triangle[t].edge[a] % f->size);
      side[count++] = (EqmFlipSide){f->triangle[t].edge[a], f->rank, t, a, f->triangle[t]};
    }
    f->changed[t] = PETSC_FALSE;
  }
  PetscCall(EqmExchangeBytes(f->comm, count, sizeof(*side), destination, side, &num_received, &received));
  for (PetscInt k = 0; k < num_received; k++) {
    const PetscInt *const v = received[k].shape.vertex, a = received[k].corner;
    const PetscInt which = v[(a + 1) % 3] < v[(a + 2) % 3] ? 0 : 1;
    EqmFlipEdge *const edge = &f->edge[received[k].edge / f->size];
    edge->side[which] = received[k];
    edge->known[which] = edge->dirty = PETSC_TRUE;
  }
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(side, destination));
  PetscFunctionReturn(0);
}

/* Is the edge not Delaunay, and are both its triangles known? No edge from a vertex to itself is made. */
static PetscBool IsFlippable(const EqmFlipEdge *edge)
{
  const EqmFlipSide *const a = &edge->side[0], *const b = &edge->side[1];
  PetscReal cot[2];

  if (!edge->known[0] || !edge->known[1]) return PETSC_FALSE;
  if (a->shape.vertex[a->corner] == b->shape.vertex[b->corner]) return PETSC_FALSE;
  cot[0] = Cotangent(&a->shape, a->corner);
  cot[1] = Cotangent(&b->shape, b->corner);
  return (PetscBool)(cot[0] + cot[1] < -1e-12 * (1. + PetscAbsReal(cot[0]) + PetscAbsReal(cot[1])));
}

/* Edges that are not Delaunay request both their triangles; a triangle chooses one of the requests. */
static PetscErrorCode RequestFlips(EqmFlipper *f, PetscInt64 *requests)
{
  PetscInt count = 0, num_received;
  PetscMPIInt *destination;
  EqmEdgeId *claim, *received;

  PetscFunctionBegin;
  *requests = 0;
  for (PetscInt e = 0; e < f->num_edges; e++) {
    f->edge[e].approvals = 0;
    f->edge[e].dirty = (PetscBool)(f->edge[e].dirty && IsFlippable(&f->edge[e]));
    *requests += f->edge[e].dirty;
  }
  PetscCall(PetscMalloc2(2 * (PetscInt)*requests, &claim, 2 * (PetscInt)*requests, &destination));
  for (PetscInt e = 0; e < f->num_edges; e++) {
    for (PetscInt s = 0; s < 2 && f->edge[e].dirty; s++) {
      destination[count] = (PetscMPIInt)f->edge[e].side[s].rank;
      claim[count++] = (EqmEdgeId){f->edge[e].side[s].triangle, s, f->size * e + f->rank};
    }
  }
  PetscCall(EqmExchangeBytes(f->comm, count, sizeof(*claim), destination, claim, &num_received, &received));
  PetscCall(PetscFree2(claim, destination));
  for (PetscInt t = 0; t < f->num_triangles; t++) f->claimed[t] = -1;
  for (PetscInt k = 0; k < num_received; k++) {
    PetscInt *const best = &f->claimed[received[k].triangle];
    if (*best < 0 || Mix(received[k].edge) > Mix(*best) ||
        (Mix(received[k].edge) == Mix(*best) && received[k].edge > *best))
      *best = received[k].edge;
  }
  PetscCall(PetscFree(received));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, requests, 1, MPIU_INT64, MPI_SUM, f->comm));
  PetscFunctionReturn(0);
}

/* The triangles' choices are sent to the edges. */
static PetscErrorCode CollectApprovals(EqmFlipper *f)
{
  PetscInt count = 0, num_received, *edge, *received;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(f->num_triangles, &edge, f->num_triangles, &destination));
  for (PetscInt t = 0; t < f->num_triangles; t++) {
    if (f->claimed[t] < 0) continue;
    destination[count] = (PetscMPIInt)(f->claimed[t] % f->size);
    edge[count++] = f->claimed[t];
  }
  PetscCall(EqmExchangeBytes(f->comm, count, sizeof(*edge), destination, edge, &num_received, &received));
  for (PetscInt k = 0; k < num_received; k++) f->edge[received[k] / f->size].approvals++;
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(edge, destination));
  PetscFunctionReturn(0);
}

/* The other diagonal of the two triangles, laid flat beside each other. Before: (p, q, r) and (s, r, q) with the edge
   q r; after: (p, q, s) and (s, r, p). */
static void Flip(const EqmFlipSide *a, const EqmFlipSide *b, EqmFlipTriangle *first, EqmFlipTriangle *second)
{
  const PetscInt i = a->corner, j = b->corner;
  const PetscInt i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  const EqmFlipTriangle *const t = &a->shape, *const u = &b->shape;
  const PetscReal l = t->length[i];
  const PetscReal x = .5 * (l + (t->length[i2] - t->length[i1]) * (t->length[i2] + t->length[i1]) / l);
  const PetscReal y = .5 * (l + (u->length[j1] - u->length[j2]) * (u->length[j1] + u->length[j2]) / l);
  const PetscReal height = (2. * (EqmAreaOfLengths(t->length) + EqmAreaOfLengths(u->length))) / l;
  const PetscReal diagonal = PetscSqrtReal(PetscSqr(x - y) + PetscSqr(height));

  *first = (EqmFlipTriangle){{t->vertex[i], t->vertex[i1], u->vertex[j]},
                             {u->edge[j1], a->edge, t->edge[i2]},
                             {u->length[j1], diagonal, t->length[i2]}};
  *second = (EqmFlipTriangle){{u->vertex[j], t->vertex[i2], t->vertex[i]},
                              {t->edge[i1], a->edge, u->edge[j2]},
                              {t->length[i1], diagonal, u->length[j2]}};
}

/* Edges with two approvals flip, and send their triangles the new shapes. */
static PetscErrorCode FlipEdges(EqmFlipper *f)
{
  PetscInt count = 0, num_received;
  PetscMPIInt *destination;
  Update *update, *received;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < f->num_edges; e++) count += f->edge[e].approvals == 2 ? 2 : 0;
  f->flips += count / 2;
  PetscCall(PetscMalloc2(count, &update, count, &destination));
  count = 0;
  for (PetscInt e = 0; e < f->num_edges; e++) {
    const EqmFlipSide *const side = f->edge[e].side;
    if (f->edge[e].approvals != 2) continue;
    for (PetscInt s = 0; s < 2; s++) {
      update[count + s].triangle = side[s].triangle;
      update[count + s].unused = 0;
      destination[count + s] = (PetscMPIInt)side[s].rank;
    }
    Flip(&side[0], &side[1], &update[count].shape, &update[count + 1].shape);
    count += 2;
  }
  PetscCall(EqmExchangeBytes(f->comm, count, sizeof(*update), destination, update, &num_received, &received));
  for (PetscInt k = 0; k < num_received; k++) {
    f->triangle[received[k].triangle] = received[k].shape;
    f->changed[received[k].triangle] = PETSC_TRUE;
  }
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(update, destination));
  PetscFunctionReturn(0);
}

/* The soup with the triangles as they are now, and their lengths. */
static PetscErrorCode MakeFlippedSoup(const EqmFlipper *f, EqmSoup soup, EqmSoup *flipped)
{
  PetscFunctionBegin;
  PetscCall(EqmSoupCopy(soup, flipped));
  PetscCall(PetscFree((*flipped)->density)); /* of triangles that are no more */
  PetscCall(PetscMalloc1(3 * f->num_triangles, &(*flipped)->edge_length));
  for (PetscInt k = 0; k < 3 * f->num_triangles; k++) {
    (*flipped)->cells[k] = f->triangle[k / 3].vertex[k % 3];
    (*flipped)->edge_length[k] = f->triangle[k / 3].length[k % 3];
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupFlip(EqmSoup soup, EqmSoup *flipped, PetscInt64 *flips)
{
  EqmFlipper f = {.comm = soup->comm, .num_triangles = soup->cell_end - soup->cell_start};
  PetscInt64 requests = 1;

  PetscFunctionBegin;
  PetscCheck(soup->cell_size == 3, soup->comm, PETSC_ERR_ARG_WRONG, "only edges of triangles are flipped");
  PetscCallMPI(MPI_Comm_rank(f.comm, &f.rank));
  PetscCallMPI(MPI_Comm_size(f.comm, &f.size));
  PetscCall(EqmFlipperMakeTriangles(soup, &f));
  PetscCall(EqmFlipperNumberEdges(&f));
  while (requests > 0) { /* ends: every flip lowers the Dirichlet energies of all functions */
    PetscCall(SendTrianglesToEdges(&f));
    PetscCall(RequestFlips(&f, &requests));
    PetscCall(CollectApprovals(&f));
    PetscCall(FlipEdges(&f));
  }
  PetscCall(MakeFlippedSoup(&f, soup, flipped));
  PetscCall(MPIU_Allreduce(&f.flips, flips, 1, MPIU_INT64, MPI_SUM, f.comm));
  PetscCall(PetscFree3(f.triangle, f.changed, f.claimed));
  PetscCall(PetscFree(f.edge));
  PetscFunctionReturn(0);
}
