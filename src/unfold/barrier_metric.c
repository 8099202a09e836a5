/* What the barrier against folds adds to the metric of L-BFGS: A/2 times the positive part of its Hessian, cell by
   cell; without it, the metric knows nothing of what holds the cells that matter most. */
#include "unfold/barrier.h"
#include "energy/kernel.h"

/* The corners' degrees of freedom as directions in space. */
typedef struct {
  PetscInt count, corner[12];
  PetscReal direction[12][3];
} CellFrame;

static void FindFrame(EqmSolver solver, PetscInt cell, CellFrame *frame)
{
  frame->count = 0;
  for (PetscInt a = 0; a < 4; a++) {
    PetscReal axes[9];
    const PetscInt count = EqmDomainFrame(solver->domain, &solver->place, solver->mesh->cells[4 * cell + a], axes);
    for (PetscInt k = 0; k < count; k++, frame->count++) {
      frame->corner[frame->count] = a;
      for (PetscInt c = 0; c < 3; c++) frame->direction[frame->count][c] = axes[3 * k + c];
    }
  }
}

/* The barrier's term of a cell at the present map. */
static EqmBarrierTerm TermOf(EqmSolver solver, PetscInt cell)
{
  const EqmBarrier barrier = solver->barrier;

  return EqmBarrierOfCell(barrier, solver->image[cell] / (solver->mesh->weight[cell] * barrier->total),
                          EqmBarrierStretch(barrier, solver->mesh, solver->place.x, cell));
}

/* Factor of da da^T. */
static PetscReal Stiffness(EqmMesh mesh, PetscInt cell, const EqmBarrierTerm *term)
{
  return .5 * PetscMax(0., term->second) / (mesh->num_cells * PetscSqr(mesh->weight[cell]));
}

/* Factor of the edges' weights. */
static PetscReal ShapeFactor(EqmSolver solver, const EqmBarrierTerm *term)
{
  return PetscSqr(solver->barrier->total) * term->by_stretch / solver->mesh->num_cells;
}

static void AddSquare(const CellFrame *frame, PetscReal factor, PetscReal gradient[4][3], PetscReal *matrix)
{
  PetscReal rate[12];

  for (PetscInt i = 0; i < frame->count; i++) rate[i] = EqmDot3(gradient[frame->corner[i]], frame->direction[i]);
  for (PetscInt i = 0; i < frame->count; i++) {
    for (PetscInt j = 0; j < frame->count; j++) matrix[frame->count * i + j] += factor * rate[i] * rate[j];
  }
}

/* The cell between the origin and a facet of this cell. */
static void AddFacet(EqmSolver solver, PetscInt cell, PetscInt facet, const CellFrame *frame, PetscReal *matrix)
{
  const EqmMesh mesh = solver->mesh;
  const EqmBarrier barrier = solver->barrier;
  const PetscReal *const x = solver->place.x;
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
  AddSquare(frame, .5 * PetscMax(0., term.second) / (barrier->num_facets * PetscSqr(barrier->share[facet])), gradient,
            matrix);
}

void EqmBarrierAddMatrix(EqmSolver solver, PetscInt cell, PetscReal *matrix)
{
  const EqmMesh mesh = solver->mesh;
  const EqmBarrier barrier = solver->barrier;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = solver->place.x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  const EqmBarrierTerm term = TermOf(solver, cell);
  PetscReal gradient[4][3], laplacian[4][4];
  CellFrame frame;

  FindFrame(solver, cell, &frame);
  EqmVolumeGradient(p, gradient[0]);
  AddSquare(&frame, Stiffness(mesh, cell, &term), gradient, matrix);
  EqmCellLaplacian(4, barrier->edge + 6 * cell, laplacian);
  for (PetscInt i = 0; i < frame.count; i++) {
    for (PetscInt j = 0; j < frame.count; j++)
      matrix[frame.count * i + j] += ShapeFactor(solver, &term) * laplacian[frame.corner[i]][frame.corner[j]] *
                                     EqmDot3(frame.direction[i], frame.direction[j]);
  }
  for (PetscInt k = 0; k < 4; k++) {
    const PetscInt facet = barrier->facet_of[4 * cell + k];
    if (facet >= 0) AddFacet(solver, cell, facet, &frame, matrix);
  }
}
