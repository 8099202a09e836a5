/* The barrier against folds in one cell: its function with derivatives, and its matrix, half the positive part of the
   Hessian, cell by cell. In the metric of L-BFGS that stands for what holds the cells that matter most. */
#include "problem/barrier.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

EqmBarrierTerm EqmBarrierOfCell(EqmBarrier barrier, PetscReal ratio, PetscReal stretch)
{
  const PetscReal eps = barrier->epsilon, root = PetscSqrtReal(eps * eps + ratio * ratio);
  const PetscReal chi = ratio > 0. ? .5 * (ratio + root) : .5 * eps * eps / (root - ratio);
  const PetscReal first = chi / root, second = .5 * eps * eps / (root * root * root), half = .5 * (1. + ratio * ratio);
  const PetscReal power = PetscPowReal(chi, -2. / 3.), shape = barrier->shape_weight * power / 3.;
  const PetscReal relative = first / chi, relative_second = second / chi;

  return (EqmBarrierTerm){
      .value = barrier->weight * half / chi + shape * stretch,
      .first = barrier->weight * (ratio - half * relative) / chi - 2. / 3. * shape * stretch * relative,
      .second = barrier->weight *
                    (1. - 2. * ratio * relative - half * relative_second + 2. * half * relative * relative) / chi +
                shape * stretch * (10. / 9. * relative * relative - 2. / 3. * relative_second),
      .by_stretch = shape};
}

PetscReal EqmBarrierStretch(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt cell)
{
  const PetscInt *const v = mesh->cells + 4 * cell;
  PetscReal sum = 0.;

  for (PetscInt e = 0; e < 6; e++) {
    PetscInt i, j;
    EqmCellEdge(4, e, &i, &j);
    for (PetscInt k = 0; k < 3; k++) sum += barrier->edge[6 * cell + e] * PetscSqr(x[3 * v[i] + k] - x[3 * v[j] + k]);
  }
  return sum;
}

/* The corner of a facet, seen from the centre. */
static void Seen(EqmBarrier barrier, const PetscReal *x, PetscInt v, PetscReal place[3])
{
  for (PetscInt k = 0; k < 3; k++) place[k] = x[3 * v + k] - barrier->center[k];
}

void EqmBarrierFacetNormal(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt facet, PetscInt b,
                           PetscReal normal[3])
{
  const PetscInt *const v = mesh->boundary_facets + 3 * facet;
  PetscReal p[3], q[3];

  Seen(barrier, x, v[(b + 1) % 3], p);
  Seen(barrier, x, v[(b + 2) % 3], q);
  EqmCross(p, q, normal);
}

PetscReal EqmBarrierFacetRatio(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt facet)
{
  const PetscInt *const v = mesh->boundary_facets + 3 * facet;

  PetscReal p[3][3];

  for (PetscInt a = 0; a < 3; a++) Seen(barrier, x, v[a], p[a]);
  return EqmHalfDet(p[0], p[1], p[2]) / (3. * barrier->share[facet] * barrier->total);
}

/* The barrier's term of a cell at the present map. */
static EqmBarrierTerm TermOf(EqmBarrier barrier, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                             PetscInt cell)
{
  return EqmBarrierOfCell(barrier, image[cell] / (problem->mesh->weight[cell] * barrier->total),
                          EqmBarrierStretch(barrier, problem->mesh, place->x, cell));
}

/* Factor of da da^T, of the matrix times T. */
static PetscReal Stiffness(EqmMesh mesh, PetscInt cell, const EqmBarrierTerm *term)
{
  return .5 * PetscMax(0., term->second) / (mesh->num_cells * PetscSqr(mesh->weight[cell]));
}

/* Factor of the edges' weights, of the matrix times T. */
static PetscReal ShapeFactor(EqmBarrier barrier, EqmMesh mesh, const EqmBarrierTerm *term)
{
  return PetscSqr(barrier->total) * term->by_stretch / mesh->num_cells;
}

/* The cell between the centre and a facet of this cell. */
static void AddFacet(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt cell, PetscInt facet,
                     const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  const PetscInt *const v = mesh->boundary_facets + 3 * facet;
  const EqmBarrierTerm term = EqmBarrierOfCell(barrier, EqmBarrierFacetRatio(barrier, mesh, x, facet), 0.);
  PetscReal gradient[4][3] = {{0.}};

  for (PetscInt a = 0; a < 4; a++) {
    for (PetscInt b = 0; b < 3; b++) {
      if (mesh->cells[4 * cell + a] != v[b]) continue;
      EqmBarrierFacetNormal(barrier, mesh, x, facet, b, gradient[a]);
      for (PetscInt k = 0; k < 3; k++) gradient[a][k] /= 6.;
    }
  }
  EqmCellFrameAddSquare(frame,
                        factor *
                            (.5 * PetscMax(0., term.second) / (barrier->num_facets * PetscSqr(barrier->share[facet]))),
                        gradient, matrix);
}

void EqmBarrierAddMatrix(EqmTerm base, EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                         const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  const EqmMesh mesh = problem->mesh;
  const EqmBarrier barrier = (EqmBarrier)base;
  const PetscReal scale = factor / barrier->total;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = place->x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  const EqmBarrierTerm term = TermOf(barrier, problem, place, image, cell);
  PetscReal gradient[4][3], laplacian[4][4];

  EqmVolumeGradient(p, gradient[0]);
  EqmCellFrameAddSquare(frame, scale * Stiffness(mesh, cell, &term), gradient, matrix);
  EqmCellLaplacian(4, barrier->edge + 6 * cell, laplacian);
  EqmCellFrameAddLaplacian(frame, scale * ShapeFactor(barrier, mesh, &term), laplacian, matrix);
  for (PetscInt k = 0; k < 4; k++) {
    const PetscInt facet = barrier->facet_of[4 * cell + k];
    if (facet >= 0) AddFacet(barrier, mesh, x, cell, facet, frame, scale, matrix);
  }
}
