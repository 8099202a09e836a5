/* What the barrier against folds adds to the metric of L-BFGS: A/2 times the positive part of its Hessian, cell by
   cell; without it, the metric knows nothing of what holds the cells that matter most. */
#include "problem/barrier.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

/* The barrier's term of a cell at the present map. */
static EqmBarrierTerm TermOf(EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell)
{
  const EqmBarrier barrier = problem->barrier;

  return EqmBarrierOfCell(barrier, image[cell] / (problem->mesh->weight[cell] * barrier->total),
                          EqmBarrierStretch(barrier, problem->mesh, place->x, cell));
}

/* Factor of da da^T. */
static PetscReal Stiffness(EqmMesh mesh, PetscInt cell, const EqmBarrierTerm *term)
{
  return .5 * PetscMax(0., term->second) / (mesh->num_cells * PetscSqr(mesh->weight[cell]));
}

/* Factor of the edges' weights. */
static PetscReal ShapeFactor(EqmProblem problem, const EqmBarrierTerm *term)
{
  return PetscSqr(problem->barrier->total) * term->by_stretch / problem->mesh->num_cells;
}

/* The cell between the origin and a facet of this cell. */
static void AddFacet(EqmProblem problem, const EqmPlace *place, PetscInt cell, PetscInt facet,
                     const EqmCellFrame *frame, PetscReal *matrix)
{
  const EqmMesh mesh = problem->mesh;
  const EqmBarrier barrier = problem->barrier;
  const PetscReal *const x = place->x;
  const PetscInt *const v = mesh->boundary_facets + 3 * facet;
  const EqmBarrierTerm term = EqmBarrierOfCell(barrier, EqmBarrierFacetRatio(barrier, mesh, x, facet), 0.);
  PetscReal gradient[4][3] = {{0.}};

  for (PetscInt a = 0; a < 4; a++) {
    for (PetscInt b = 0; b < 3; b++) {
      if (mesh->cells[4 * cell + a] != v[b]) continue;
      EqmCross(x + 3 * v[(b + 1) % 3], x + 3 * v[(b + 2) % 3], gradient[a]);
      for (PetscInt k = 0; k < 3; k++) gradient[a][k] /= 6.;
    }
  }
  EqmCellFrameAddSquare(frame, .5 * PetscMax(0., term.second) / (barrier->num_facets * PetscSqr(barrier->share[facet])),
                        gradient, matrix);
}

void EqmBarrierAddMatrix(EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                         const EqmCellFrame *frame, PetscReal *matrix)
{
  const EqmMesh mesh = problem->mesh;
  const EqmBarrier barrier = problem->barrier;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = place->x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  const EqmBarrierTerm term = TermOf(problem, place, image, cell);
  PetscReal gradient[4][3], laplacian[4][4];

  EqmVolumeGradient(p, gradient[0]);
  EqmCellFrameAddSquare(frame, Stiffness(mesh, cell, &term), gradient, matrix);
  EqmCellLaplacian(4, barrier->edge + 6 * cell, laplacian);
  EqmCellFrameAddLaplacian(frame, ShapeFactor(problem, &term), laplacian, matrix);
  for (PetscInt k = 0; k < 4; k++) {
    const PetscInt facet = barrier->facet_of[4 * cell + k];
    if (facet >= 0) AddFacet(problem, place, cell, facet, frame, matrix);
  }
}
