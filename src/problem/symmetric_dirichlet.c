/* The symmetric Dirichlet energy of maps to the plane (Smith and Schaefer 2015): with the mesh scaled to the target's
   measure T and J the map's derivative in a triangle,

       E = T sum w [ |J|^2 (1 + 1/det^2) / 4 - 1 ],

   zero for isometries alone and infinite for folds: neither areas nor angles may be far off. |J|^2 T w is the sum D of
   cot |x_i - x_j|^2 over the triangle's edges, whatever the mesh's size, and det = a / (T w). */
#include "problem/objective.h"
#include "domain/domain_private.h"
#include "energy/loops.h"
#include <math.h>

/* D of a cell. */
static PetscReal Stretch(EqmMesh mesh, const PetscReal *cotangent, const PetscReal *x, PetscInt cell)
{
  const PetscInt *const v = mesh->cells + 3 * cell;
  PetscReal sum = 0.;

  for (PetscInt e = 0; e < 3; e++) {
    const PetscReal *const p = x + 2 * v[(e + 1) % 3], *const q = x + 2 * v[(e + 2) % 3];
    sum += cotangent[3 * cell + e] * (PetscSqr(p[0] - q[0]) + PetscSqr(p[1] - q[1]));
  }
  return sum;
}

/* Cells of one range: the value, infinite where one folds; slopes by the measures, weights of the edges. */
static PetscReal SumRange(EqmDomain domain, const PetscReal *cotangent, const PetscReal *x, const PetscReal *image,
                          PetscInt b, PetscReal *slope, PetscReal *flow)
{
  const EqmMesh mesh = domain->mesh;
  const PetscReal total = domain->target_measure;
  PetscReal sum = 0.;

  for (PetscInt c = EqmRangeStart(mesh->num_local_cells, b); c < EqmRangeStart(mesh->num_local_cells, b + 1); c++) {
    const PetscReal share = total * mesh->weight[c], det = image[c] / share, stretch = Stretch(mesh, cotangent, x, c);
    const PetscReal factor = det > 0. ? .25 * (1. + 1. / (det * det)) : INFINITY;
    if (c < mesh->num_owned_cells) sum += stretch * factor - share;
    slope[c] = -.5 * stretch / (det * det * det * share);
    for (PetscInt e = 0; e < 3; e++) flow[3 * c + e] = 2. * factor * cotangent[3 * c + e];
  }
  return sum;
}

static PetscErrorCode Gradient(EqmDomain domain, const EqmPlace *place, const PetscReal *slope, const PetscReal *flow,
                               Vec gradient)
{
  const PetscInt n = 2 * domain->mesh->num_owned;
  PetscReal *by_area, *by_edges;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &by_area, n, &by_edges));
  PetscCall(EqmImageGradient(domain, place, slope, by_area));
  PetscCall(EqmLaplacianApply(domain->mesh, flow, 2, place->x, by_edges));
  for (PetscInt k = 0; k < n; k++) by_area[k] += by_edges[k];
  PetscCall(EqmDomainProject(domain, place, by_area, gradient));
  PetscCall(PetscFree2(by_area, by_edges));
  PetscFunctionReturn(0);
}

static PetscErrorCode Evaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal *image,
                               PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal part[EQM_NUM_RANGES], sum = 0., *slope, *flow;
  const PetscReal *cotangent;

  PetscFunctionBegin;
  (void)iterate;
  PetscCall(EqmProblemGetAngleWeights(problem, &cotangent));
  PetscCall(EqmImageMeasure(problem->domain, place, image));
  PetscCall(PetscMalloc2(mesh->num_local_cells, &slope, 3 * mesh->num_local_cells, &flow));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++)
    part[b] = SumRange(problem->domain, cotangent, place->x, image, b, slope, flow);
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum += part[b];
  PetscCall(MPIU_Allreduce(&sum, value, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  if (!(*value < INFINITY)) *value = INFINITY;
  if (gradient) PetscCall(Gradient(problem->domain, place, slope, flow, gradient));
  PetscCall(PetscFree2(slope, flow));
  PetscFunctionReturn(0);
}

/* The Hessian of D f(det) - T w, f = (1 + 1/det^2)/4: f D'' + f' (D' det' + det' D') + D (f'' det' det' + f' det''), D
   quadratic in the places with half the second derivative the cotangents' Laplacian. */
static void SetHessian(EqmProblem problem, EqmIterate iterate, PetscInt cell, const EqmCellDerivatives *d,
                       PetscReal *matrix)
{
  const EqmDomain domain = problem->domain;
  const PetscInt n = d->frame.count, *const v = domain->mesh->cells + 3 * cell;
  const PetscReal share = domain->target_measure * domain->mesh->weight[cell], det = iterate->image[cell] / share;
  const PetscReal f = .25 * (1. + 1. / (det * det)), first = -.5 / (det * det * det),
                  second = 1.5 / (det * det * det * det);
  const PetscReal stretch = Stretch(domain->mesh, problem->angle_weights, iterate->place.x, cell);
  PetscReal laplacian[4][4], ambient[6], by_dof[EQM_MOST_CELL_DOFS];

  EqmCellLaplacian(3, problem->angle_weights + 3 * cell, laplacian);
  for (PetscInt k = 0; k < 6; k++) {
    ambient[k] = 0.;
    for (PetscInt b = 0; b < 3; b++) ambient[k] += 2. * laplacian[k / 2][b] * iterate->place.x[2 * v[b] + k % 2];
  }
  for (PetscInt i = 0; i < n; i++)
    by_dof[i] = ambient[2 * d->frame.corner[i]] * d->frame.direction[i][0] +
                ambient[2 * d->frame.corner[i] + 1] * d->frame.direction[i][1];
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt j = 0; j < n; j++) {
      matrix[n * i + j] =
          first / share * (by_dof[i] * d->first[j] + d->first[i] * by_dof[j]) +
          stretch * (second / (share * share) * d->first[i] * d->first[j] + first / share * d->second[i][j]);
    }
    const PetscInt a = d->frame.corner[i];
    const PetscReal curvature = EqmDomainMotion(domain, v[a])->curvature, *const x = iterate->place.x + 2 * v[a];
    matrix[n * i + i] -= f * curvature * (ambient[2 * a] * x[0] + ambient[2 * a + 1] * x[1]);
  }
  EqmCellFrameAddLaplacian(&d->frame, 2. * f, laplacian, matrix);
}

/* The Laplacian of the edges' part, times T: its inverse is scaled by T again. */
static PetscErrorCode Metric(EqmProblem problem, const EqmPlace *place, PetscReal *weights, PetscReal *mass,
                             PetscBool *with_mass)
{
  const PetscReal total = problem->domain->target_measure, *cotangent;
  PetscReal *image;

  PetscFunctionBegin;
  (void)mass;
  *with_mass = PETSC_FALSE;
  PetscCall(EqmProblemGetAngleWeights(problem, &cotangent));
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &image));
  PetscCall(EqmImageMeasure(problem->domain, place, image));
  for (PetscInt k = 0; k < 3 * problem->mesh->num_local_cells; k++) {
    const PetscReal det = image[k / 3] / (total * problem->mesh->weight[k / 3]);
    weights[k] = .5 * total * (1. + 1. / (det * det)) * cotangent[k];
  }
  PetscCall(PetscFree(image));
  PetscFunctionReturn(0);
}

const EqmObjective EqmObjectiveSymmetricDirichlet = {.name = "symmetric-dirichlet",
                                                     .sum = EqmSumMeasures,
                                                     .evaluate = Evaluate,
                                                     .set_hessian = SetHessian,
                                                     .metric = Metric,
                                                     .inverse_scale = 1.,
                                                     .planar_only = PETSC_TRUE};
