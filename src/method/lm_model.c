/* The Gauss-Newton model at the present map: matrix, right-hand sides, step and second-order correction. */
#include "method/lm.h"
#include "domain/domain_private.h"
#include "energy/cellframe.h"
#include "energy/loops.h"
#include "geometry/simplex.h"

/* Motions that change nothing are in the matrix's null space where the damping is small: the diagonal keeps it
   definite. */
static const PetscReal diagonal_factor = 1. + 1e-12;

/* Stiffness of the damping's metric in a cell: what the squared distances of the corners' displacements from their
   mean are multiplied by. Weighted by the residual: stiff where the map is wrong. */
static inline PetscReal Damping(const EqmLm *lm, PetscInt cell)
{
  const PetscReal floor = .3 * PetscSqrtReal(lm->now.squares);

  return .5 * PetscSqrtReal(3.) * lm->mu * (PetscAbsReal(lm->now.residual[cell]) + floor);
}

/* Gauss-Newton of the residual, damping and terms of one cell, in the degrees of freedom of its vertices. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmMethod method = context;
  const EqmLm *const lm = method->data;
  const EqmDomain domain = method->problem->domain;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell, dim = domain->dim;
  const PetscReal *const x = lm->now.place.x, *const p[] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
  const PetscReal damping = Damping(lm, cell), weight = mesh->weight[cell];
  PetscReal area[3 * EQM_MAX_CORNERS], first[EQM_MOST_CELL_DOFS];
  EqmCellFrame frame;

  EqmCellFrameFind(domain, &lm->now.place, cell, &frame);
  EqmMeasureGradient(domain->measure, p, area);
  for (PetscInt i = 0; i < frame.count; i++) {
    PetscReal along = 0.;
    for (PetscInt k = 0; k < dim; k++) along += area[dim * frame.corner[i] + k] * frame.direction[i][k];
    first[i] = lm->slope[cell] * along;
  }
  for (PetscInt i = 0; i < frame.count; i++) {
    for (PetscInt j = 0; j < frame.count; j++) {
      const PetscReal dot = EqmDot3(frame.direction[i], frame.direction[j]);
      matrix[frame.count * i + j] =
          weight * (first[i] * first[j]) + damping * dot * (frame.corner[i] == frame.corner[j] ? 2. / 3. : -1. / 3.);
    }
  }
  EqmTermsAddMatrix(method->problem, &lm->now.place, lm->now.image, cell, &frame, lm->term_scale, matrix);
}

/* sum over cells of w value d rho in degrees of freedom; NULL for `value`: ones. Collective. */
static PetscErrorCode PullBack(EqmMethod method, const PetscReal *value, Vec result)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal *scaled;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &scaled));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++)
    scaled[c] = mesh->weight[c] * (lm->slope[c] * (value ? value[c] : 1.));
  PetscCall(EqmImageGradient(method->problem->domain, &lm->now.place, scaled, lm->ambient));
  PetscCall(PetscFree(scaled));
  PetscCall(EqmDomainProject(method->problem->domain, &lm->now.place, lm->ambient, result));
  PetscFunctionReturn(0);
}

/* The mean's rank-one term, by Sherman and Morrison: z += y (g.z) / (1 - g.y). Nothing to do where the residual keeps
   it. */
static PetscErrorCode AddMeanTerm(EqmLm *lm, Vec z)
{
  PetscReal gz;

  PetscFunctionBegin;
  if (!lm->residual->without_mean) PetscFunctionReturn(0);
  PetscCall(VecDot(lm->mean, z, &gz));
  PetscCall(VecAXPY(z, gz / PetscMax(1. - lm->mean_product, 1e-12), lm->solved_mean));
  PetscFunctionReturn(0);
}

/* Euclidean norms of two fields of n reals on this rank, with one reduction. Collective. */
static PetscErrorCode Norms(EqmMesh mesh, PetscInt n, const PetscReal *x, const PetscReal *y, PetscReal norm[2])
{
  PetscFunctionBegin;
  norm[0] = norm[1] = 0.;
  for (PetscInt k = 0; k < n; k++) {
    norm[0] += x[k] * x[k];
    norm[1] += y[k] * y[k];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, norm, 2, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (int k = 0; k < 2; k++) norm[k] = PetscSqrtReal(norm[k]);
  PetscFunctionReturn(0);
}

/* d and y from the present factor; `success` is false if an iteration finds the matrix not to be definite. Collective.
 */
PetscErrorCode EqmLmSolveForStep(EqmMethod method, PetscBool *success)
{
  EqmLm *const lm = method->data;
  const PetscInt n = method->problem->domain->num_dofs, num_rhs = lm->residual->without_mean ? 2 : 1;
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
  PetscCall(VecDot(lm->mean, lm->solved_mean, &lm->mean_product));
  PetscCall(AddMeanTerm(lm, lm->step));
  PetscFunctionReturn(0);
}

/* First and second derivative of the residual along the geodesic of the step, into rho_first and rho_second. */
static PetscErrorCode DifferentiateAlongStep(EqmMethod method)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const EqmDomain domain = method->problem->domain;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpand(domain, &lm->now.place, lm->step, lm->velocity));
  PetscCall(EqmDomainCurvature(domain, &lm->now.place, lm->velocity, lm->acceleration));
  PetscCall(EqmImageDerivatives(domain, &lm->now.place, lm->velocity, lm->acceleration, lm->rho_first, lm->rho_second));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal rho, first, second;
    const PetscReal log_first = lm->rho_first[c] / lm->now.image[c],
                    log_second = lm->rho_second[c] / lm->now.image[c] - log_first * log_first;
    lm->residual->at(PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
    lm->rho_first[c] = first * log_first;
    lm->rho_second[c] = first * log_second + second * log_first * log_first;
  }
  if (lm->residual->without_mean) PetscCall(EqmRemoveWeightedMean(mesh, lm->rho_second));
  PetscFunctionReturn(0);
}

/* Geodesic acceleration: d2 = -1/2 H^-1 J^T W rho'' along the geodesic of velocity d; `ratio` = |d2| / |d| as
   displacements. Leaves the step's velocity in lm->velocity. `success` as of EqmLmSolveForStep. Collective. */
PetscErrorCode EqmLmSolveForCurve(EqmMethod method, PetscReal *ratio, PetscBool *success)
{
  EqmLm *const lm = method->data;
  const EqmProblem problem = method->problem;
  const PetscInt n = problem->domain->dim * problem->mesh->num_owned;
  PetscReal norm[2];
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(DifferentiateAlongStep(method));
  PetscCall(PullBack(method, lm->rho_second, lm->curve));
  PetscCall(EqmTermsAddCurve(problem, &lm->now.place, lm->now.image, lm->velocity, lm->acceleration, lm->term_scale,
                             lm->curve));
  PetscCall(VecGetArray(lm->curve, &array));
  PetscCall(EqmLinearTrySolve(lm->linear, 1, array, array, success));
  PetscCall(VecRestoreArray(lm->curve, &array));
  PetscCall(AddMeanTerm(lm, lm->curve));
  PetscCall(VecScale(lm->curve, -.5));
  PetscCall(EqmDomainExpand(problem->domain, &lm->now.place, lm->curve, lm->acceleration));
  PetscCall(Norms(problem->mesh, n, lm->velocity, lm->acceleration, norm));
  PetscCheck(norm[1] <= PETSC_MAX_REAL, method->comm, PETSC_ERR_FP, "the second-order correction is not finite");
  *ratio = norm[0] > 0. ? norm[1] / norm[0] : 0.;
  PetscFunctionReturn(0);
}

/* mu d^T M d of the step, whose velocity lm->velocity has: per cell its damping times the squared distances of the
   corners' displacements from their mean. Collective. */
static PetscErrorCode DampingEnergy(EqmMethod method, PetscReal *energy)
{
  const EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  const PetscInt dim = method->problem->domain->dim;
  PetscReal part[EQM_NUM_RANGES], local = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
      const PetscInt *const v = mesh->cells + 3 * c;
      PetscReal squared = 0.;
      for (PetscInt k = 0; k < dim; k++) {
        const PetscReal d[3] = {lm->velocity[dim * v[0] + k], lm->velocity[dim * v[1] + k],
                                lm->velocity[dim * v[2] + k]};
        squared += (PetscSqr(d[0] - d[1]) + PetscSqr(d[1] - d[2]) + PetscSqr(d[2] - d[0])) / 3.;
      }
      part[b] += Damping(lm, c) * squared;
    }
  }
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) local += part[b];
  PetscCall(MPIU_Allreduce(&local, energy, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* What the model without damping promises for the full step d, (H + mu M) d = -b: -2 b.d - d^T H d = -b.d + mu d^T M d,
   a sum of two numbers that are not negative. Collective. */
PetscErrorCode EqmLmPredictedDecrease(EqmMethod method, PetscReal *decrease)
{
  EqmLm *const lm = method->data;
  PetscReal slope, damping;

  PetscFunctionBegin;
  PetscCall(VecDot(lm->descent, lm->step, &slope));
  PetscCall(DampingEnergy(method, &damping));
  *decrease = slope + damping;
  PetscFunctionReturn(0);
}

/* Slopes d rho / d a and minus half the gradient of the objective at the present map. Collective. */
PetscErrorCode EqmLmGradient(EqmMethod method)
{
  EqmLm *const lm = method->data;
  const EqmMesh mesh = method->problem->mesh;
  PetscReal value = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal rho, first, second;
    lm->residual->at(PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
    lm->slope[c] = first / lm->now.image[c];
  }
  PetscCall(PullBack(method, lm->now.residual, lm->descent));
  PetscCall(VecZeroEntries(lm->part));
  PetscCall(EqmTermsAdd(method->problem, &lm->now.place, lm->now.image, &value, lm->part));
  PetscCall(VecAXPBY(lm->descent, -.5 * lm->term_scale, -1., lm->part));
  PetscFunctionReturn(0);
}

/* That of the objective. Collective. */
PetscErrorCode EqmLmGradientNorm(EqmMethod method, PetscReal *norm)
{
  const EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(VecNorm(lm->descent, NORM_2, norm));
  *norm *= 2.;
  PetscFunctionReturn(0);
}

/* Gradient, its norm and the mean's vector at the present map. Collective. */
PetscErrorCode EqmLmLinearise(EqmMethod method, EqmIterate iterate)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmGradient(method));
  PetscCall(EqmLmGradientNorm(method, &iterate->gradient_norm));
  if (lm->residual->without_mean) PetscCall(PullBack(method, NULL, lm->mean));
  PetscFunctionReturn(0);
}

/* Factor the matrix at the present map with the present damping. Collective. */
PetscErrorCode EqmLmFactor(EqmMethod method, PetscBool *success)
{
  EqmLm *const lm = method->data;

  PetscFunctionBegin;
  PetscCall(EqmLmPrepareLinear(method));
  PetscCall(EqmLinearFactor(lm->linear, CellMatrix, method, diagonal_factor, success));
  PetscFunctionReturn(0);
}

/* q <- H^-1 q with the present factor, the mean's term included; `context` is the method. lm->mean must be the
   factor's. Whether the result is finite is for the caller to find out. Collective. */
PetscErrorCode EqmLmApplyInverse(void *context, Vec q)
{
  const EqmMethod method = context;
  EqmLm *const lm = method->data;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(q, &array));
  PetscCall(EqmLinearSolveStep(lm->linear, array));
  PetscCall(VecRestoreArray(q, &array));
  PetscCall(AddMeanTerm(lm, q));
  PetscFunctionReturn(0);
}
