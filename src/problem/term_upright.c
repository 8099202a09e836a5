/* Maps to the sphere: a barrier against triangles that tip over, sum w q^2 of q = log(h / a), h half the determinant of
   a triangle's corners and a its area: zero where the sphere is touched, infinite where the centre lies in the
   triangle's plane (docs/methods.md). */
#include "problem/term.h"
#include "domain/domain_private.h"
#include "energy/loops.h"
#include "geometry/simplex.h"
#include <math.h>

/* h and a of each local cell; a is `image` where that is flat areas. Collective. */
static PetscErrorCode FindMeasures(EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                   PetscReal *half_det, PetscReal *area)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(problem->domain, EQM_MEASURE_HALF_DET, place, half_det));
  if (problem->domain->measure == EQM_MEASURE_AREA3)
    PetscCall(PetscArraycpy(area, image, problem->mesh->num_local_cells));
  else
    PetscCall(EqmImageMeasureOf(problem->domain, EQM_MEASURE_AREA3, place, area));
  PetscFunctionReturn(0);
}

/* q of each local cell, infinite where h or a is not positive. */
static void FindResiduals(EqmMesh mesh, const PetscReal *half_det, const PetscReal *area, PetscReal *q)
{
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++)
    q[c] = half_det[c] > 0. && area[c] > 0. ? PetscLogReal(half_det[c] / area[c]) : INFINITY;
}

/* result += factor sum w value d q: d q = d h / h - d a / a. Collective. */
static PetscErrorCode AddTransposed(EqmProblem problem, const EqmPlace *place, const PetscReal *area,
                                    const PetscReal *half_det, const PetscReal *value, PetscReal factor, Vec result)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = problem->domain->dim * mesh->num_owned;
  PetscReal *slope, *by_area, *by_det;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_local_cells, &slope, n, &by_area, n, &by_det));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) slope[c] = -factor * mesh->weight[c] * value[c] / area[c];
  PetscCall(EqmImageGradientOf(problem->domain, EQM_MEASURE_AREA3, place, slope, by_area));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) slope[c] = factor * mesh->weight[c] * value[c] / half_det[c];
  PetscCall(EqmImageGradientOf(problem->domain, EQM_MEASURE_HALF_DET, place, slope, by_det));
  for (PetscInt k = 0; k < n; k++) by_area[k] += by_det[k];
  PetscCall(EqmDomainAddProjected(problem->domain, place, by_area, result));
  PetscCall(PetscFree3(slope, by_area, by_det));
  PetscFunctionReturn(0);
}

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt n = mesh->num_local_cells;
  PetscReal *half_det, *area, *q, squares;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &half_det, n, &area, n, &q));
  PetscCall(FindMeasures(problem, place, image, half_det, area));
  FindResiduals(mesh, half_det, area, q);
  PetscCall(EqmWeightedSum(mesh, q, 2, &squares));
  *value += term->weight * squares;
  if (gradient && squares < INFINITY)
    PetscCall(AddTransposed(problem, place, area, half_det, q, 2. * term->weight, gradient));
  PetscCall(PetscFree3(half_det, area, q));
  PetscFunctionReturn(0);
}

static void AddMatrix(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image, PetscInt cell,
                      const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix)
{
  const PetscInt *const v = problem->mesh->cells + 3 * cell;
  const PetscReal *const p[] = {place->x + 3 * v[0], place->x + 3 * v[1], place->x + 3 * v[2]};
  const PetscReal half_det = EqmHalfDet(p[0], p[1], p[2]), flat = EqmArea3(p[0], p[1], p[2]);
  PetscReal area[3 * EQM_MAX_CORNERS], det[3 * EQM_MAX_CORNERS], gradient[4][3];

  (void)image;
  EqmMeasureGradient(EQM_MEASURE_AREA3, p, area);
  EqmMeasureGradient(EQM_MEASURE_HALF_DET, p, det);
  for (PetscInt k = 0; k < 9; k++) gradient[k / 3][k % 3] = det[k] / half_det - area[k] / flat;
  EqmCellFrameAddSquare(frame, factor * term->weight * problem->mesh->weight[cell], gradient, matrix);
}

static PetscErrorCode AddCurve(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                               const PetscReal *velocity, const PetscReal *acceleration, PetscReal factor, Vec result)
{
  const PetscInt n = problem->mesh->num_local_cells;
  PetscReal *half_det, *area, *rate[2], *second[2];

  PetscFunctionBegin;
  PetscCall(PetscMalloc6(n, &half_det, n, &area, n, &rate[0], n, &second[0], n, &rate[1], n, &second[1]));
  PetscCall(FindMeasures(problem, place, image, half_det, area));
  PetscCall(
      EqmImageDerivativesOf(problem->domain, EQM_MEASURE_AREA3, place, velocity, acceleration, rate[0], second[0]));
  PetscCall(
      EqmImageDerivativesOf(problem->domain, EQM_MEASURE_HALF_DET, place, velocity, acceleration, rate[1], second[1]));
  for (PetscInt c = 0; c < n; c++) { /* q'' into second[1] */
    const PetscReal of_area = rate[0][c] / area[c], of_det = rate[1][c] / half_det[c];
    second[1][c] = second[1][c] / half_det[c] - of_det * of_det - (second[0][c] / area[c] - of_area * of_area);
  }
  PetscCall(AddTransposed(problem, place, area, half_det, second[1], factor * term->weight, result));
  PetscCall(PetscFree6(half_det, area, rate[0], second[0], rate[1], second[1]));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmTerm term)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(term));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTermCreateUpright(EqmProblem problem, PetscReal weight, EqmTerm *term)
{
  PetscFunctionBegin;
  PetscCheck(problem->domain->curved_image, problem->comm, PETSC_ERR_ARG_INCOMP, "only triangles on a sphere tip over");
  PetscCall(PetscNew(term));
  **term = (struct _p_EqmTerm){.name = "upright",
                               .weight = weight,
                               .add = Add,
                               .add_matrix = AddMatrix,
                               .add_curve = AddCurve,
                               .destroy = Destroy};
  PetscFunctionReturn(0);
}
