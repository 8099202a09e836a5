/* Folds of angle-preserving maps to the disk. Where the two angles opposite to an edge add up to more than pi the
   weight of the edge is negative, and the harmonic map may fold. If such weights are replaced by a small positive
   number, the harmonic map for the new weights does not fold, as the boundary is strictly convex (Tutte 1963, Floater
   1997). As this distorts angles, only edges around folds are changed, then those around the folds that remain, and in
   the last round all of them. */
#include "unfold/unfold.h"
#include "mesh/mesh_private.h"
#include "base/sort.h"

enum { MOST_ROUNDS = 30 };
static const PetscReal least_weight = 1e-2; /* of an edge; between equilateral triangles it is 1/sqrt(3) */

typedef struct {
  PetscInt low, high, slot; /* local vertices; which cell and edge */
} Side;

typedef struct {
  Side *side;         /* of all edges, the two of an edge one after the other */
  PetscReal *weights; /* cotangents, those of changed edges raised */
  PetscReal *marked;  /* per local vertex: 1 where it is near a fold, else 0 */
} Unfold;

static int CompareSides(const void *a, const void *b)
{
  const Side *const s = a, *const t = b;

  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  return (s->high > t->high) - (s->high < t->high);
}

/* All cells around owned vertices are here, and their rows are all that counts. Not collective. */
static void SortSides(EqmMesh mesh, Side *side)
{
  const PetscInt n = 3 * mesh->num_local_cells;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 3), p = v[(k + 1) % 3], q = v[(k + 2) % 3];
    side[k] = (Side){PetscMin(p, q), PetscMax(p, q), k};
  }
  EqmSort(side, (size_t)n, sizeof(Side), CompareSides);
}

/* Raise the weights of edges with a marked end. Not collective. */
static void MakePositive(EqmMesh mesh, Unfold *u)
{
  const Side *const side = u->side;

  for (PetscInt k = 0; k + 1 < 3 * mesh->num_local_cells; k++) {
    PetscReal *const one = u->weights + side[k].slot, *const other = u->weights + side[k + 1].slot;
    if (CompareSides(&side[k], &side[k + 1]) || *one + *other >= least_weight) continue;
    if (u->marked[side[k].low] > 0. || u->marked[side[k].high] > 0.) *one = *other = .5 * least_weight;
  }
}

/* Mark the corners of folded cells, or everything. Collective. */
static PetscErrorCode Mark(EqmMesh mesh, const PetscReal *image, PetscBool everything, PetscReal *marked)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3 * mesh->num_local_cells; k++) {
    if (everything || !(image[k / 3] > 0.)) marked[mesh->cells[k]] = 1.;
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, marked));
  PetscFunctionReturn(0);
}

/* Round by round from the present map, whose folds `after` counts; the best map goes to `best`. */
static PetscErrorCode Straighten(EqmProblem problem, EqmIterate iterate, Unfold *u, EqmPlace *best, PetscInt64 *after)
{
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(problem->domain, &to));
  for (PetscInt round = 1; round <= MOST_ROUNDS && (*after) > 0; round++) {
    PetscInt64 folds;
    PetscCall(Mark(problem->mesh, iterate->image, (PetscBool)(round == MOST_ROUNDS), u->marked));
    MakePositive(problem->mesh, u);
    PetscCall(EqmHarmonicMap(problem, u->weights, &iterate->place, &to));
    PetscCall(EqmImageFolds(problem->domain, &to, iterate->image, &folds));
    if (folds >= *after) continue;
    *after = folds;
    PetscCall(EqmPlaceCopy(problem->domain, &to, best));
  }
  PetscCall(EqmPlaceDestroy(&to));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDiskUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before, PetscInt64 *after)
{
  const EqmMesh mesh = problem->mesh;
  const PetscReal *angle_weights;
  EqmPlace best;
  Unfold u;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &angle_weights));
  PetscCall(PetscMalloc2(3 * mesh->num_local_cells, &u.side, 3 * mesh->num_local_cells, &u.weights));
  PetscCall(PetscCalloc1(mesh->num_local, &u.marked));
  PetscCall(PetscArraycpy(u.weights, angle_weights, 3 * mesh->num_local_cells));
  SortSides(mesh, u.side);
  PetscCall(EqmPlaceCreate(problem->domain, &best));
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best));
  PetscCall(EqmImageFolds(problem->domain, &best, iterate->image, before));
  *after = *before;
  PetscCall(Straighten(problem, iterate, &u, &best, after));
  PetscCall(EqmPlaceCopy(problem->domain, &best, &iterate->place));
  PetscCall(EqmPlaceDestroy(&best));
  PetscCall(PetscFree2(u.side, u.weights));
  PetscCall(PetscFree(u.marked));
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscFunctionReturn(0);
}
