/* The boundary of the first map of a solid to the cube: the surface, mapped to the sphere by the caller, is divided
   into six faces (cube_faces.c); edges are laid out by length, faces by Tutte's map with equal weights, which folds
   nowhere as a square is convex. */
#include "start/start.h"
#include "start/cube_faces.h"
#include "base/narrow.h"
#include "geometry/rotation.h"
#include "geometry/simplex.h"
#include "problem/objective.h"

/* A piece of an edge of the cube: a side of the mesh, its left face on its left. */
typedef struct {
  PetscInt edge, end[2]; /* global numbers */
  PetscReal length;      /* on the sphere */
  PetscReal at;          /* where it begins, in parts of the edge */
} Piece;

/* The rotation that brings the places on the sphere nearest to the solid's own, sum m |R x - p|^2 over the surface:
   the cube's axes are those in which the solid is given. */
static PetscErrorCode TurnOf(EqmMesh mesh, const PetscReal *x, PetscReal turn[9])
{
  PetscReal *mass, sum[15] = {0.}, correlation[9]; /* sums of p q^T, p and q */

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local, &mass));
  PetscCall(EqmMeshVertexWeights(mesh, mass));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscReal *const p = mesh->position + 3 * v, *const q = x + 3 * v;
    for (PetscInt k = 0; k < 9; k++) sum[k] += mass[v] * p[k / 3] * q[k % 3];
    for (PetscInt k = 0; k < 6; k++) sum[9 + k] += mass[v] * (k < 3 ? p[k] : q[k - 3]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 15, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 9; k++) correlation[k] = sum[k] - sum[9 + k / 3] * sum[12 + k % 3];
  PetscCall(PetscFree(mass));
  PetscCall(EqmBestRotation(3, correlation, turn));
  PetscFunctionReturn(0);
}

/* The edge of the cube that a side of the mesh is a piece of, if its triangle is in the left face; -1: of none. */
static PetscInt EdgeOfSide(const EqmCubeFaces *cube, const PetscInt v[3], PetscInt a)
{
  const PetscInt i = v[a], j = v[(a + 1) % 3];
  const PetscInt both = EqmCubeFacesOf(cube, i) & EqmCubeFacesOf(cube, j);
  const PetscInt faces = both & EqmCubeFacesOf(cube, v[(a + 2) % 3]);

  for (PetscInt e = 0; e < EQM_CUBE_EDGES; e++) {
    if (both == (1 << cube->edge[e].left | 1 << cube->edge[e].right) && faces == 1 << cube->edge[e].left) return e;
  }
  return -1;
}

/* All pieces, on every rank: as many as the edges are long. */
static PetscErrorCode CollectPieces(const EqmCubeFaces *cube, PetscInt *count, Piece **pieces)
{
  const EqmMesh mesh = cube->mesh;
  PetscSegBuffer buffer;
  PetscMPIInt *counts, *starts;
  MPI_Datatype type;
  Piece *slot;
  size_t size;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(Piece), 64, &buffer));
  for (PetscInt k = 0; k < 3 * mesh->num_owned_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 3), i = v[k % 3], j = v[(k % 3 + 1) % 3];
    const PetscInt e = EdgeOfSide(cube, v, k % 3);
    if (e < 0) continue;
    const PetscReal *const p = cube->x + 3 * i, *const q = cube->x + 3 * j;
    PetscCall(PetscSegBufferGet(buffer, 1, &slot));
    *slot = (Piece){.edge = e,
                    .end = {mesh->global[i], mesh->global[j]},
                    .length = PetscSqrtReal(PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]) + PetscSqr(p[2] - q[2]))};
  }
  PetscCall(PetscSegBufferGetSize(buffer, &size));
  PetscCall(PetscSegBufferExtractAlloc(buffer, &slot));
  PetscCall(PetscSegBufferDestroy(&buffer));
  PetscCall(PetscMalloc2(mesh->size, &counts, mesh->size + 1, &starts));
  PetscCall(EqmGatherCounts(mesh->comm, (PetscInt64)size, "sides along the cube's edges", counts, starts));
  *count = starts[mesh->size];
  PetscCall(PetscMalloc1(*count, pieces));
  PetscCallMPI(MPI_Type_contiguous(sizeof(Piece), MPI_BYTE, &type));
  PetscCallMPI(MPI_Type_commit(&type));
  PetscCallMPI(MPI_Allgatherv(slot, counts[mesh->rank], type, *pieces, counts, starts, type, mesh->comm));
  PetscCallMPI(MPI_Type_free(&type));
  PetscCall(PetscFree2(counts, starts));
  PetscCall(PetscFree(slot));
  PetscFunctionReturn(0);
}

/* The piece of an edge that begins at a vertex; NULL: there is none. */
static Piece *FindPiece(PetscInt count, Piece *pieces, PetscInt edge, PetscInt vertex)
{
  for (PetscInt k = 0; k < count; k++) {
    if (pieces[k].edge == edge && pieces[k].end[0] == vertex) return &pieces[k];
  }
  return NULL;
}

/* Go along an edge and tell its pieces where they are; false unless they are one way from corner to corner. */
static PetscBool WalkEdge(const EqmCubeFaces *cube, PetscInt edge, PetscInt count, Piece *pieces)
{
  const PetscInt last = cube->corner_vertex[cube->edge[edge].to];
  PetscInt here = cube->corner_vertex[cube->edge[edge].from], steps = 0, of_edge = 0;
  PetscReal length = 0.;

  for (PetscInt k = 0; k < count; k++) of_edge += pieces[k].edge == edge;
  while (here != last && steps++ < of_edge) {
    Piece *const piece = FindPiece(count, pieces, edge, here);
    if (!piece) return PETSC_FALSE;
    piece->at = length;
    length += piece->length;
    here = piece->end[1];
  }
  for (PetscInt k = 0; k < count; k++) {
    if (pieces[k].edge == edge) pieces[k].at /= length;
  }
  return (PetscBool)(here == last && steps == of_edge);
}

/* Pieces of edges that are simple ways, and hold every vertex that is on one. */
static PetscErrorCode FindAllPieces(const EqmCubeFaces *cube, PetscInt *count, Piece **pieces)
{
  PetscInt fine = 1, all;

  PetscFunctionBegin;
  PetscCall(CollectPieces(cube, count, pieces));
  for (PetscInt e = 0; e < EQM_CUBE_EDGES; e++) fine &= WalkEdge(cube, e, *count, *pieces);
  for (PetscInt v = 0; v < cube->mesh->num_local; v++) {
    const PetscInt e = (PetscInt)cube->on_edge[v];
    fine &= e < 0 || FindPiece(*count, *pieces, e, cube->mesh->global[v]);
  }
  PetscCall(MPIU_Allreduce(&fine, &all, 1, MPIU_INT, MPI_MIN, cube->mesh->comm));
  if (!all) PetscCall(EqmCubeTooCoarse(cube->mesh, "an edge is no simple way from corner to corner"));
  PetscFunctionReturn(0);
}

/* Corners and edges to their places in the cube, z, three per local vertex; the rest to its face. */
static PetscErrorCode LayOutEdges(const EqmCubeFaces *cube, signed char *group, PetscReal *z)
{
  const EqmMesh mesh = cube->mesh;
  PetscInt count;
  Piece *pieces;

  PetscFunctionBegin;
  PetscCall(FindAllPieces(cube, &count, &pieces));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscInt label = (PetscInt)cube->label[v], e = (PetscInt)cube->on_edge[v];
    const PetscInt corner = label >= EQM_CUBE_FACES ? label - EQM_CUBE_FACES : e >= 0 ? cube->edge[e].from : -1;
    group[v] = corner >= 0 ? EQM_GROUP_FIXED : 0;
    for (PetscInt k = 0; k < 3; k++) z[3 * v + k] = corner >= 0 ? corner >> k & 1 : .5;
    if (corner < 0) z[3 * v + label / 2] = label % 2;
    if (e < 0) continue;
    const PetscReal t = FindPiece(count, pieces, e, mesh->global[v])->at;
    z[3 * v + cube->edge[e].axis] = corner >> cube->edge[e].axis & 1 ? 1. - t : t;
  }
  PetscCall(PetscFree(pieces));
  PetscFunctionReturn(0);
}

/* Tutte's map of each face; the faces' own coordinates are exact. */
static PetscErrorCode LayOutFaces(const EqmCubeFaces *cube, const signed char *group, PetscReal *z)
{
  const EqmMesh mesh = cube->mesh;
  EqmProblem problem;
  EqmDomain domain;
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreate(mesh, "sphere", NULL, &domain));
  PetscCall(EqmProblemCreate(domain, &EqmObjectiveAuthalic, &problem));
  PetscCall(PetscMalloc1(3 * mesh->num_local_cells, &weights));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_UNIFORM, NULL, weights));
  PetscCall(EqmHeldSolve(problem, weights, group, 3, z));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscInt face = (PetscInt)cube->label[v];
    if (group[v] != EQM_GROUP_FIXED) z[3 * v + face / 2] = face % 2;
  }
  PetscCall(PetscFree(weights));
  PetscCall(EqmProblemDestroy(&problem));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeFromSphere(EqmMesh surface, PetscReal *x)
{
  EqmCubeFaces cube;
  PetscReal turn[9], *z;
  signed char *group;

  PetscFunctionBegin;
  PetscCall(TurnOf(surface, x, turn));
  PetscCall(EqmCubeFacesCreate(surface, x, turn, &cube));
  PetscCall(PetscMalloc2(3 * surface->num_local, &z, surface->num_local, &group));
  PetscCall(LayOutEdges(&cube, group, z));
  PetscCall(LayOutFaces(&cube, group, z));
  PetscCall(PetscArraycpy(x, z, 3 * surface->num_local));
  PetscCall(PetscFree2(z, group));
  PetscCall(EqmCubeFacesDestroy(&cube));
  PetscFunctionReturn(0);
}
