/* The Gauss-Newton model at the present map: matrix, right-hand sides, step and bend. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include "energy/cellframe.h"
#include "geometry/simplex.h"

/* d rho and (sphere, else zero) d q by each degree of freedom of a cell. */
static inline void CellGradients(EqmMethod method, PetscInt cell, const EqmCellFrame *frame, PetscReal of_rho[6],
                                 PetscReal of_lean[6])
{
  const EqmLm *const lm = method->data;
  const EqmDomain domain = method->problem->domain;
  const PetscInt *const v = method->problem->mesh->cells + 3 * cell, dim = domain->dim;
  const PetscReal *const x = lm->now.place.x, *const p[] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
  PetscReal area[3 * EQM_MAX_CORNERS], det[3 * EQM_MAX_CORNERS];

  EqmMeasureGradient(domain->measure, p, area);
  if (lm->kappa > 0.) EqmMeasureGradient(EQM_MEASURE_HALF_DET, p, det);
  for (PetscInt i = 0; i < frame->count; i++) {
    const PetscReal *const direction = frame->direction[i];
    const PetscInt first = dim * frame->corner[i];
    PetscReal along_area = 0., along_det = 0.;
    for (PetscInt k = 0; k < dim; k++) along_area += area[first + k] * direction[k];
    of_rho[i] = lm->slope[cell] * along_area;
    of_lean[i] = 0.;
    if (!(lm->kappa > 0.)) continue;
    for (PetscInt k = 0; k < dim; k++) along_det += det[first + k] * direction[k];
    of_lean[i] = along_det / lm->now.half_det[cell] - along_area / lm->now.image[cell];
  }
}

/* Gauss-Newton, metric and angle energy of one cell, in the degrees of freedom of its vertices. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmMethod method = context;
  const EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell;
  const PetscReal floor = .3 * PetscSqrtReal(lm->now.squares);
  const PetscReal elastic = .5 * PetscSqrtReal(3.) * lm->mu * (PetscAbsReal(lm->now.residual[cell]) + floor);
  const PetscReal angle = .5 * lm->angle_weight, weight = mesh->weight[cell];
  const PetscBool drawn = (PetscBool)(method->problem->landmarks.num > 0);
  PetscReal of_rho[6], of_lean[6];
  EqmCellFrame frame;

  EqmCellFrameFind(method->problem->domain, &lm->now.place, cell, &frame);
  CellGradients(method, cell, &frame, of_rho, of_lean);
  for (PetscInt i = 0; i < frame.count; i++) {
    for (PetscInt j = 0; j < frame.count; j++) {
      const PetscReal *const u = frame.direction[i], *const e = frame.direction[j], dot = EqmDot3(u, e);
      const PetscInt a = frame.corner[i], b = frame.corner[j];
      PetscReal entry = weight * (of_rho[i] * of_rho[j] + lm->kappa * of_lean[i] * of_lean[j]) +
                        elastic * dot * (a == b ? 2. / 3. : -1. / 3.);
      if (angle > 0.) { /* L - Hess A; Hess A couples x of one corner with y of the next: +-1/2 */
        const PetscReal *const w = lm->laplacian + 3 * cell;
        const PetscReal cross = u[0] * e[1] - u[1] * e[0];
        entry += angle * dot * (a == b ? w[(a + 1) % 3] + w[(a + 2) % 3] : -w[3 - a - b]);
        if (a != b) entry -= angle * cross * (b == (a + 1) % 3 ? .5 : -.5);
      }
      if (drawn && a == b) entry += method->problem->landmarks.share[v[a]] * dot;
      matrix[frame.count * i + j] = entry;
    }
  }
}

/* sum over cells of w (value d rho + kappa lean_value d q), and half the gradient of the other terms (angle energy,
   landmarks), in degrees of freedom. NULL for `value`: ones; for `lean_value`: nothing. */
static PetscErrorCode PullBack(EqmMethod method, const PetscReal *value, const PetscReal *lean_value,
                               PetscBool with_others, Vec result)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt n = method->problem->domain->dim * mesh->num_owned;
  const PetscReal angle = with_others ? .5 * lm->angle_weight : 0.;
  PetscReal *scaled, *pull;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local_cells, &scaled, n, &pull));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscReal lean = lean_value ? lm->kappa * lean_value[c] / lm->now.image[c] : 0.;
    scaled[c] = mesh->weight[c] * (lm->slope[c] * (value ? value[c] : 1.) - lean) - angle;
  }
  PetscCall(EqmImageGradient(method->problem->domain, &lm->now.place, scaled, lm->ambient));
  if (lean_value) {
#pragma omp parallel for schedule(static)
    for (PetscInt c = 0; c < mesh->num_local_cells; c++)
      scaled[c] = mesh->weight[c] * lm->kappa * lean_value[c] / lm->now.half_det[c];
    PetscCall(EqmImageGradientOf(method->problem->domain, EQM_MEASURE_HALF_DET, &lm->now.place, scaled, pull));
    for (PetscInt k = 0; k < n; k++) lm->ambient[k] += pull[k];
  }
  if (angle > 0.) {
    PetscCall(EqmLaplacianApply(mesh, lm->laplacian, 2, lm->now.place.x, pull));
    for (PetscInt k = 0; k < n; k++) lm->ambient[k] += angle * pull[k];
  }
  if (with_others)
    EqmLandmarksAddGradient(&method->problem->landmarks, method->problem->domain, lm->now.place.x,
                            method->problem->landmarks.weight, lm->ambient);
  PetscCall(PetscFree2(scaled, pull));
  PetscCall(EqmDomainProject(method->problem->domain, &lm->now.place, lm->ambient, result));
  PetscFunctionReturn(0);
}

/* The mean's rank-one term, by Sherman and Morrison: z += y (g.z) / (1 - g.y). Nothing to do for the balanced residual.
 */
static PetscErrorCode AddMeanTerm(EqmLm *lm, Vec z)
{
  PetscReal gz, gy;

  PetscFunctionBegin;
  if (lm->epsilon > 0.) PetscFunctionReturn(0);
  PetscCall(VecDot(lm->mean, z, &gz));
  PetscCall(VecDot(lm->mean, lm->solved_mean, &gy));
  PetscCall(VecAXPY(z, gz / PetscMax(1. - gy, 1e-12), lm->solved_mean));
  PetscFunctionReturn(0);
}

static PetscErrorCode Norm(EqmMesh mesh, PetscInt n, const PetscReal *x, PetscReal *norm)
{
  PetscReal local = 0., sum;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) local += x[k] * x[k];
  PetscCall(MPIU_Allreduce(&local, &sum, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *norm = PetscSqrtReal(sum);
  PetscFunctionReturn(0);
}

/* d and y from the present factor; `success` is false if an iteration finds the matrix not to be definite. Collective.
 */
PetscErrorCode EqmLmSolveForStep(EqmMethod method, PetscBool *success)
{
  EqmLm *const lm = method->data;
  const PetscInt n = method->problem->domain->num_dofs, num_rhs = lm->epsilon > 0. ? 1 : 2;
  const PetscScalar *b, *g;
  PetscScalar *d, *y;
  PetscReal *columns;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n, &columns));
  PetscCall(VecGetArrayRead(lm->descent, &b));
  PetscCall(VecGetArrayRead(lm->mean, &g));
  PetscCall(PetscArraycpy(columns, b, n));
  PetscCall(PetscArraycpy(columns + n, g, n));
  PetscCall(VecRestoreArrayRead(lm->descent, &b));
  PetscCall(VecRestoreArrayRead(lm->mean, &g));
  PetscCall(EqmLinearTrySolve(lm->linear, num_rhs, columns, columns, success));
  PetscCall(VecGetArrayWrite(lm->step, &d));
  PetscCall(VecGetArrayWrite(lm->solved_mean, &y));
  PetscCall(PetscArraycpy(d, columns, n));
  PetscCall(PetscArraycpy(y, columns + n, n));
  PetscCall(VecRestoreArrayWrite(lm->step, &d));
  PetscCall(VecRestoreArrayWrite(lm->solved_mean, &y));
  PetscCall(PetscFree(columns));
  PetscCall(AddMeanTerm(lm, lm->step));
  PetscFunctionReturn(0);
}

/* Geodesic acceleration: d2 = -1/2 H^-1 J^T W rho'' along the geodesic of velocity d; `ratio` = |d2| / |d| as
 * displacements. */
PetscErrorCode EqmLmSolveForCurve(EqmMethod method, PetscReal *ratio)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal step_norm, curve_norm;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpand(method->problem->domain, &lm->now.place, lm->step, lm->velocity));
  PetscCall(EqmDomainCurvature(method->problem->domain, &lm->now.place, lm->velocity, lm->acceleration));
  PetscCall(
      EqmImageDerivatives(method->problem->domain, &lm->now.place, lm->velocity, lm->acceleration, lm->rate, lm->bend));
  if (lm->kappa > 0.) {
    PetscCall(EqmImageDerivativesOf(method->problem->domain, EQM_MEASURE_HALF_DET, &lm->now.place, lm->velocity,
                                    lm->acceleration, lm->lean_rate, lm->lean_bend));
  }
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal rho, first, second;
    const PetscReal log_rate = lm->rate[c] / lm->now.image[c],
                    log_bend = lm->bend[c] / lm->now.image[c] - log_rate * log_rate;
    EqmLmResidual((PetscBool)(lm->epsilon > 0.), PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho,
                  &first, &second);
    if (lm->kappa > 0.) {
      const PetscReal det_rate = lm->lean_rate[c] / lm->now.half_det[c];
      lm->lean_bend[c] = lm->lean_bend[c] / lm->now.half_det[c] - det_rate * det_rate - log_bend;
      lm->lean_rate[c] = det_rate - log_rate;
    }
    lm->rate[c] = first * log_rate;
    lm->bend[c] = first * log_bend + second * log_rate * log_rate;
  }
  if (!(lm->epsilon > 0.)) PetscCall(EqmLmRemoveMean(mesh, lm->bend));
  PetscCall(PullBack(method, lm->bend, lm->kappa > 0. ? lm->lean_bend : NULL, PETSC_FALSE, lm->curve));
  PetscCall(VecGetArray(lm->curve, &array));
  PetscCall(EqmLinearSolve(lm->linear, 1, array, array));
  PetscCall(VecRestoreArray(lm->curve, &array));
  PetscCall(AddMeanTerm(lm, lm->curve));
  PetscCall(VecScale(lm->curve, -.5));
  PetscCall(EqmDomainExpand(method->problem->domain, &lm->now.place, lm->curve, lm->acceleration));
  PetscCall(Norm(mesh, method->problem->domain->dim * mesh->num_owned, lm->velocity, &step_norm));
  PetscCall(Norm(mesh, method->problem->domain->dim * mesh->num_owned, lm->acceleration, &curve_norm));
  *ratio = step_norm > 0. ? curve_norm / step_norm : 0.;
  PetscFunctionReturn(0);
}

/* What the linear model promises for the full step. Leaves rate and bend used up. */
PetscErrorCode EqmLmPredictedDecrease(EqmMethod method, PetscReal *decrease)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal squares;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) lm->rate[c] += lm->now.residual[c];
  if (!(lm->epsilon > 0.)) PetscCall(EqmLmRemoveMean(mesh, lm->rate));
  PetscCall(EqmLmWeightedSum(mesh, lm->rate, 2, &squares));
  *decrease = lm->now.squares - squares;
  if (lm->kappa > 0.) {
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) lm->lean_rate[c] += lm->now.lean[c];
    PetscCall(EqmLmWeightedSum(mesh, lm->lean_rate, 2, &squares));
    *decrease += lm->kappa * (lm->now.barrier - squares);
  }
  if (method->problem->landmarks.num_total > 0) {
    PetscCall(EqmLandmarksSquares(&method->problem->landmarks, method->problem->domain, lm->now.place.x, lm->velocity,
                                  &squares));
    *decrease += method->problem->landmarks.weight * (lm->now.pull - squares);
  }
  if (lm->epsilon > 0.) {
    PetscReal quadratic, linear, local = 0.;
    PetscReal *pull, *gradient;
    PetscCall(EqmLmAngleEnergy(method, lm->velocity, &quadratic));
    PetscCall(PetscMalloc2(2 * mesh->num_owned, &pull, 2 * mesh->num_owned, &gradient));
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) lm->bend[c] = 1.;
    PetscCall(EqmImageGradient(method->problem->domain, &lm->now.place, lm->bend, gradient));
    PetscCall(EqmLaplacianApply(mesh, lm->laplacian, 2, lm->now.place.x, pull));
    for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) local += (pull[k] - gradient[k]) * lm->velocity[k];
    PetscCall(PetscFree2(pull, gradient));
    PetscCall(MPIU_Allreduce(&local, &linear, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
    *decrease -= lm->angle_weight * (linear + quadratic);
  }
  PetscFunctionReturn(0);
}

/* Slopes d rho / d a and minus half the gradient of the objective at the present map. Collective. */
PetscErrorCode EqmLmGradient(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal norm;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal first = 1.;
    if (lm->epsilon > 0.) { /* only there does the slope depend on the residual */
      PetscReal rho, second;
      EqmLmResidual(PETSC_TRUE, PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
    }
    lm->slope[c] = first / lm->now.image[c];
  }
  PetscCall(PullBack(method, lm->now.residual, lm->kappa > 0. ? lm->now.lean : NULL, PETSC_TRUE, lm->descent));
  PetscCall(VecScale(lm->descent, -1.));
  PetscCall(VecNorm(lm->descent, NORM_2, &norm));
  iterate->gradient_norm = 2. * norm;
  PetscFunctionReturn(0);
}

/* Gradient and the mean's vector at the present map. Collective. */
PetscErrorCode EqmLmLinearise(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmGradient(method, iterate));
  if (!(lm->epsilon > 0.)) PetscCall(PullBack(method, NULL, NULL, PETSC_FALSE, lm->mean));
  PetscFunctionReturn(0);
}

/* Factor the matrix at the present map with the present damping. Collective. */
PetscErrorCode EqmLmFactor(EqmMethod method, PetscBool *success)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmSetFields(method));
  PetscCall(EqmLinearFactor(lm->linear, CellMatrix, method, 1. + (lm->epsilon > 0. ? 1e-11 : 1e-12), success));
  PetscFunctionReturn(0);
}

/* q <- H^-1 q with the present factor, the mean's term included; `context` is the method. lm->mean must be the factor's
   Collective. */
PetscErrorCode EqmLmApplyInverse(void *context, Vec q)
{
  const EqmMethod method = context;
  EqmLm *const lm = method->data;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(q, &array));
  PetscCall(EqmLinearSolve(lm->linear, 1, array, array));
  PetscCall(VecRestoreArray(q, &array));
  PetscCall(AddMeanTerm(lm, q));
  PetscFunctionReturn(0);
}
