/* Levenberg-Marquardt on log ratios with geodesic acceleration (METHODS sections 10 and 12).

   Minimise sum w rho^2 + (eps/T) (E_D - A): rho a residual of each cell's ratio, T the target's measure, E_D - A the angle
   energy (E_D with the mesh's cotangents). With eps = 0, rho = log(a/w) less its weighted mean; with eps > 0, rho = r - 1
   above one and log r below, r = (a/w)/A, which reaches the minimum straight from a Tutte map.

   One iteration: the coupled Gauss-Newton matrix plus mu M, where M is an elastic metric weighted by the present residual
   (stiff where the map is wrong, loose where it is right), is factored once and solved three times: for the step, for the
   mean's rank-one term, for the bend of the geodesic. */
#include "method/method.h"
#include "energy/kernel.h"
#include "energy/loops.h"

enum { MOST_DAMPINGS = 8, MOST_HALVINGS = 7 };

/* The residual of a map and what it adds up to. */
typedef struct {
  EqmPlace place;
  PetscReal *image, *residual; /* per local cell */
  PetscReal squares;           /* sum w rho^2 */
  PetscReal objective;         /* with the angle energy; infinite for a map that folds or disorders the boundary */
} Trial;

typedef struct {
  EqmLinear linear;
  PetscReal mu, epsilon, angle_weight; /* angle_weight: eps / T */
  PetscReal level;                     /* balanced: log A, held during an iteration */
  Trial now, best, attempt;
  PetscReal *laplacian;           /* cotangent weights of the mesh, if epsilon > 0 */
  PetscReal *rate, *bend, *slope; /* per local cell: d rho along the step; second derivative; d rho / d a */
  PetscReal *velocity, *acceleration, *ambient;
  Vec descent, mean, step, curve, move; /* -b, g, d, d2, t d + t^2 d2 */
  Vec solved_mean;                      /* y = H^-1 g */
} Lm;

/* ---- residuals */

/* rho and its first two derivatives by l = log((a/w)/A). */
static inline void Residual(PetscBool balanced, PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second)
{
  const PetscBool stretched = (PetscBool)(balanced && l > 0.);
  *rho = stretched ? PetscExpReal(l) - 1. : l;
  *first = stretched ? PetscExpReal(l) : 1.;
  *second = stretched ? PetscExpReal(l) : 0.;
}

/* sum over owned cells of w x^k, k = 1 or 2. */
static PetscErrorCode WeightedSum(EqmMesh mesh, const PetscReal *x, PetscInt power, PetscReal *sum)
{
  PetscReal part[EQM_NUM_RANGES], local = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
      part[b] += mesh->weight[c] * (power == 1 ? x[c] : x[c] * x[c]);
    }
  }
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) local += part[b];
  PetscCall(MPIU_Allreduce(&local, sum, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* Subtract the weighted mean: the total area is free. */
static PetscErrorCode RemoveMean(EqmMesh mesh, PetscReal *x)
{
  PetscReal mean;

  PetscFunctionBegin;
  PetscCall(WeightedSum(mesh, x, 1, &mean));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) x[c] -= mean;
  PetscFunctionReturn(0);
}

/* (E_D - A): the angle energy of places or, being quadratic in them, of displacements. */
static PetscErrorCode AngleEnergy(EqmSolver solver, const PetscReal *x, PetscReal *energy)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  EqmPlace place = {.x = (PetscReal *)x};
  PetscReal dirichlet, area, local = 0.;

  PetscFunctionBegin;
  PetscCall(EqmLaplacianEnergy(mesh, lm->laplacian, 2, x, &dirichlet));
  PetscCall(EqmImageMeasure(solver->domain, &place, lm->bend));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) local += lm->bend[c];
  PetscCall(MPIU_Allreduce(&local, &area, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  *energy = dirichlet - area;
  PetscFunctionReturn(0);
}

/* Look at trial->place. Counts one evaluation. Collective. */
static PetscErrorCode Evaluate(EqmSolver solver, Trial *trial)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscBool balanced = (PetscBool)(lm->epsilon > 0.);
  PetscReal smallest = 1., ok;
  PetscBool in_order;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  work->evaluations++;
  trial->objective = PETSC_INFINITY;
  PetscCall(EqmImageMeasure(solver->domain, &trial->place, trial->image));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    if (!(trial->image[c] > 0.)) smallest = -1.;
  }
  PetscCall(MPIU_Allreduce(&smallest, &ok, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  if (ok < 0.) PetscFunctionReturn(0);
  PetscCall(EqmDomainBoundaryInOrder(solver->domain, &trial->place, &in_order));
  if (!in_order) PetscFunctionReturn(0);
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal first, second;
    Residual(balanced, PetscLogReal(trial->image[c] / mesh->weight[c]) - lm->level, &trial->residual[c], &first, &second);
  }
  if (!balanced) PetscCall(RemoveMean(mesh, trial->residual));
  PetscCall(WeightedSum(mesh, trial->residual, 2, &trial->squares));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  trial->objective = trial->squares;
  if (balanced) {
    PetscReal angle;
    PetscCall(AngleEnergy(solver, trial->place.x, &angle));
    trial->objective += lm->angle_weight * angle;
  }
  PetscFunctionReturn(0);
}

/* ---- the matrix */

/* Gauss-Newton, metric and angle energy of one cell, in the degrees of freedom of its vertices. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmSolver solver = context;
  const Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell;
  const PetscReal *const x = lm->now.place.x;
  const PetscReal floor = .3 * PetscSqrtReal(lm->now.squares);
  const PetscReal elastic = .5 * PetscSqrtReal(3.) * lm->mu * (PetscAbsReal(lm->now.residual[cell]) + floor);
  const PetscReal angle = .5 * lm->angle_weight, gauss = mesh->weight[cell] * lm->slope[cell] * lm->slope[cell];
  PetscReal gradient[6], basis[6][2];
  PetscInt corner[6], n = 0;

  EqmArea2Gradient(x + 2 * v[0], x + 2 * v[1], x + 2 * v[2], gradient);
  for (PetscInt a = 0; a < 3; a++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(solver->domain, &lm->now.place, v[a], frame);
    for (PetscInt k = 0; k < count; k++) {
      corner[n] = a;
      basis[n][0] = frame[2 * k];
      basis[n++][1] = frame[2 * k + 1];
    }
  }
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal gi = gradient[2 * corner[i]] * basis[i][0] + gradient[2 * corner[i] + 1] * basis[i][1];
    for (PetscInt j = 0; j < n; j++) {
      const PetscReal gj = gradient[2 * corner[j]] * basis[j][0] + gradient[2 * corner[j] + 1] * basis[j][1];
      const PetscReal dot = basis[i][0] * basis[j][0] + basis[i][1] * basis[j][1];
      const PetscInt a = corner[i], b = corner[j];
      PetscReal entry = gauss * gi * gj + elastic * dot * (a == b ? 2. / 3. : -1. / 3.);
      if (angle > 0.) { /* L - Hess A; Hess A couples x of one corner with y of the next: +-1/2 */
        const PetscReal *const w = lm->laplacian + 3 * cell;
        const PetscReal cross = basis[i][0] * basis[j][1] - basis[i][1] * basis[j][0];
        entry += angle * dot * (a == b ? w[(a + 1) % 3] + w[(a + 2) % 3] : -w[3 - a - b]);
        if (a != b) entry -= angle * cross * (b == (a + 1) % 3 ? .5 : -.5);
      }
      matrix[n * i + j] = entry;
    }
  }
}

/* ---- vectors */

/* sum over cells of value * w * slope * grad a (+ angle gradient), in degrees of freedom. */
static PetscErrorCode PullBack(EqmSolver solver, const PetscReal *value, PetscBool with_angle, Vec result)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  const PetscReal angle = with_angle ? .5 * lm->angle_weight : 0.;
  PetscReal *scaled, *pull;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local_cells, &scaled, 2 * mesh->num_owned, &pull));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) scaled[c] = mesh->weight[c] * lm->slope[c] * (value ? value[c] : 1.) - angle;
  PetscCall(EqmImageGradient(solver->domain, &lm->now.place, scaled, lm->ambient));
  if (angle > 0.) {
    PetscCall(EqmLaplacianApply(mesh, lm->laplacian, 2, lm->now.place.x, pull));
    for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) lm->ambient[k] += angle * pull[k];
  }
  PetscCall(PetscFree2(scaled, pull));
  PetscCall(EqmDomainProject(solver->domain, &lm->now.place, lm->ambient, result));
  PetscFunctionReturn(0);
}

/* The mean's rank-one term, by Sherman and Morrison: z += y (g.z) / (1 - g.y). Nothing to do for the balanced residual. */
static PetscErrorCode AddMeanTerm(Lm *lm, Vec z)
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

/* d and y from the present factor. */
static PetscErrorCode SolveForStep(EqmSolver solver)
{
  Lm *const lm = solver->data;
  const PetscInt n = solver->domain->num_dofs, num_rhs = lm->epsilon > 0. ? 1 : 2;
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
  PetscCall(EqmLinearSolve(lm->linear, num_rhs, columns, columns));
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

/* Geodesic acceleration: d2 = -1/2 H^-1 J^T W rho'' along the geodesic of velocity d; `ratio` = |d2| / |d| as displacements. */
static PetscErrorCode SolveForCurve(EqmSolver solver, PetscReal *ratio)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  PetscReal step_norm, curve_norm;
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(EqmDomainExpand(solver->domain, &lm->now.place, lm->step, lm->velocity));
  PetscCall(EqmDomainCurvature(solver->domain, &lm->now.place, lm->velocity, lm->acceleration));
  PetscCall(EqmImageDerivatives(solver->domain, &lm->now.place, lm->velocity, lm->acceleration, lm->rate, lm->bend));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal rho, first, second;
    const PetscReal log_rate = lm->rate[c] / lm->now.image[c], log_bend = lm->bend[c] / lm->now.image[c] - log_rate * log_rate;
    Residual((PetscBool)(lm->epsilon > 0.), PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
    lm->rate[c] = first * log_rate;
    lm->bend[c] = first * log_bend + second * log_rate * log_rate;
  }
  if (!(lm->epsilon > 0.)) PetscCall(RemoveMean(mesh, lm->bend));
  PetscCall(PullBack(solver, lm->bend, PETSC_FALSE, lm->curve));
  PetscCall(VecGetArray(lm->curve, &array));
  PetscCall(EqmLinearSolve(lm->linear, 1, array, array));
  PetscCall(VecRestoreArray(lm->curve, &array));
  PetscCall(AddMeanTerm(lm, lm->curve));
  PetscCall(VecScale(lm->curve, -.5));
  PetscCall(EqmDomainExpand(solver->domain, &lm->now.place, lm->curve, lm->acceleration));
  PetscCall(Norm(mesh, 2 * mesh->num_owned, lm->velocity, &step_norm));
  PetscCall(Norm(mesh, 2 * mesh->num_owned, lm->acceleration, &curve_norm));
  *ratio = step_norm > 0. ? curve_norm / step_norm : 0.;
  PetscFunctionReturn(0);
}

/* What the linear model promises for the full step. Leaves rate and bend used up. */
static PetscErrorCode PredictedDecrease(EqmSolver solver, PetscReal *decrease)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  PetscReal squares;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) lm->rate[c] += lm->now.residual[c];
  if (!(lm->epsilon > 0.)) PetscCall(RemoveMean(mesh, lm->rate));
  PetscCall(WeightedSum(mesh, lm->rate, 2, &squares));
  *decrease = lm->now.squares - squares;
  if (lm->epsilon > 0.) {
    PetscReal quadratic, linear, local = 0.;
    PetscReal *pull, *gradient;
    PetscCall(AngleEnergy(solver, lm->velocity, &quadratic));
    PetscCall(PetscMalloc2(2 * mesh->num_owned, &pull, 2 * mesh->num_owned, &gradient));
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) lm->bend[c] = 1.;
    PetscCall(EqmImageGradient(solver->domain, &lm->now.place, lm->bend, gradient));
    PetscCall(EqmLaplacianApply(mesh, lm->laplacian, 2, lm->now.place.x, pull));
    for (PetscInt k = 0; k < 2 * mesh->num_owned; k++) local += (pull[k] - gradient[k]) * lm->velocity[k];
    PetscCall(PetscFree2(pull, gradient));
    PetscCall(MPIU_Allreduce(&local, &linear, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
    *decrease -= lm->angle_weight * (linear + quadratic);
  }
  PetscFunctionReturn(0);
}

/* ---- the search along t d + t^2 d2 */

static void Swap(Trial *a, Trial *b)
{
  const Trial t = *a;
  *a = *b;
  *b = t;
}

/* Look at the map at parameter t, with or without the bend; keep it if it is the best so far. */
static PetscErrorCode TryAt(EqmSolver solver, PetscReal t, PetscBool bent, PetscReal *best_t, PetscReal *objective)
{
  Lm *const lm = solver->data;

  PetscFunctionBegin;
  PetscCall(VecCopy(lm->step, lm->move));
  PetscCall(VecScale(lm->move, t));
  if (bent) PetscCall(VecAXPY(lm->move, t * t, lm->curve));
  PetscCall(EqmDomainMove(solver->domain, &lm->now.place, 1., lm->move, &lm->attempt.place));
  PetscCall(Evaluate(solver, &lm->attempt));
  *objective = lm->attempt.objective;
  if (lm->attempt.objective < (*best_t > 0. ? lm->best.objective : lm->now.objective)) {
    *best_t = t;
    Swap(&lm->attempt, &lm->best);
  }
  PetscFunctionReturn(0);
}

/* Halve t until a trial is worse than the best or the decrease is a fair share of the prediction; `best_t` 0 if nothing
   decreases the objective. */
static PetscErrorCode Search(EqmSolver solver, PetscReal ratio, PetscReal predicted, PetscReal *best_t)
{
  Lm *const lm = solver->data;
  const PetscReal share = lm->epsilon > 0. ? .1 : .3;
  PetscReal t = ratio < 1. ? 1. : 1. / ratio, objective;

  PetscFunctionBegin;
  *best_t = 0.;
  for (PetscInt halving = 0; halving < MOST_HALVINGS; halving++, t *= .5) {
    PetscCall(TryAt(solver, t, PETSC_TRUE, best_t, &objective));
    if (ratio >= 1. || halving >= 2 || lm->epsilon > 0.) PetscCall(TryAt(solver, t, PETSC_FALSE, best_t, &objective));
    if (*best_t > 0. && (objective > lm->best.objective || lm->best.objective < lm->now.objective - share * t * predicted)) break;
  }
  PetscFunctionReturn(0);
}

/* Slopes d rho / d a, gradient and the mean's vector at the present map. */
static PetscErrorCode Linearise(EqmSolver solver)
{
  Lm *const lm = solver->data;
  const EqmMesh mesh = solver->mesh;
  PetscReal norm;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal rho, first, second;
    Residual((PetscBool)(lm->epsilon > 0.), PetscLogReal(lm->now.image[c] / mesh->weight[c]) - lm->level, &rho, &first, &second);
    lm->slope[c] = first / lm->now.image[c];
  }
  PetscCall(PullBack(solver, lm->now.residual, PETSC_TRUE, lm->descent));
  PetscCall(VecScale(lm->descent, -1.));
  PetscCall(VecNorm(lm->descent, NORM_2, &norm));
  solver->gradient_norm = 2. * norm;
  PetscCall(PullBack(solver, NULL, PETSC_FALSE, lm->mean));
  PetscFunctionReturn(0);
}

static void AdaptDamping(Lm *lm, PetscReal t)
{
  if (t >= .99) lm->mu *= .1;
  else if (t < .13) lm->mu *= 31.6;
  else if (t <= .3) lm->mu *= 10.;
}

static PetscErrorCode Step(EqmSolver solver, EqmStep *outcome)
{
  Lm *const lm = solver->data;
  PetscReal t = 0.;

  PetscFunctionBegin;
  if (lm->epsilon > 0.) { /* the level follows the total area from one iteration to the next */
    lm->level = PetscLogReal(solver->totals.total);
    PetscCall(Evaluate(solver, &lm->now));
  }
  PetscCall(Linearise(solver));
  for (PetscInt damping = 0; damping < MOST_DAMPINGS && t == 0.; damping++) {
    PetscBool success;
    PetscReal ratio, predicted;
    PetscCall(EqmLinearFactor(lm->linear, CellMatrix, solver, 1. + (lm->epsilon > 0. ? 1e-11 : 1e-12), &success));
    if (success) {
      PetscCall(SolveForStep(solver));
      PetscCall(SolveForCurve(solver, &ratio));
      PetscCall(PredictedDecrease(solver, &predicted));
      PetscCall(Search(solver, ratio, predicted, &t));
    }
    if (t == 0.) lm->mu = PetscMax(10. * lm->mu, 1e-16);
  }
  *outcome = EQM_STEP_STALLED;
  if (t == 0.) PetscFunctionReturn(0);
  AdaptDamping(lm, t);
  Swap(&lm->now, &lm->best);
  PetscCall(EqmPlaceCopy(solver->domain, &lm->now.place, &solver->place));
  PetscCall(PetscArraycpy(solver->image, lm->now.image, solver->mesh->num_local_cells));
  PetscCall(EqmImageSum(solver->mesh, solver->image, &solver->totals));
  solver->step_length = t;
  solver->objective = lm->now.objective;
  *outcome = EQM_STEP_TAKEN;
  PetscFunctionReturn(0);
}

/* ---- life */

static PetscErrorCode TrialCreate(EqmSolver solver, Trial *trial)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(solver->domain, &trial->place));
  PetscCall(PetscMalloc2(solver->mesh->num_local_cells, &trial->image, solver->mesh->num_local_cells, &trial->residual));
  PetscFunctionReturn(0);
}

static PetscErrorCode TrialDestroy(Trial *trial)
{
  PetscFunctionBegin;
  PetscCall(EqmPlaceDestroy(&trial->place));
  PetscCall(PetscFree2(trial->image, trial->residual));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmSolver solver)
{
  const EqmMesh mesh = solver->mesh;
  const EqmDomain domain = solver->domain;
  const EqmUnknowns unknowns = {.num_owned = domain->num_dofs, .first = domain->dof_first, .start = domain->dof_start, .count = domain->dof_count};
  Lm *lm;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lm));
  solver->data = lm;
  lm->mu = .1;
  lm->epsilon = PetscMax(solver->settings.balance, 0.);
  lm->angle_weight = lm->epsilon / domain->target_measure;
  PetscCall(EqmLinearCreate(mesh, solver->ordering, &unknowns, PETSC_TRUE, &lm->linear));
  PetscCall(TrialCreate(solver, &lm->now));
  PetscCall(TrialCreate(solver, &lm->best));
  PetscCall(TrialCreate(solver, &lm->attempt));
  PetscCall(PetscMalloc3(mesh->num_local_cells, &lm->rate, mesh->num_local_cells, &lm->bend, mesh->num_local_cells, &lm->slope));
  PetscCall(PetscMalloc3(2 * mesh->num_local, &lm->velocity, 2 * mesh->num_local, &lm->acceleration, 2 * mesh->num_owned, &lm->ambient));
  if (lm->epsilon > 0.) {
    PetscCall(PetscMalloc1(3 * mesh->num_local_cells, &lm->laplacian));
    PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_COTANGENT, NULL, lm->laplacian));
    lm->level = PetscLogReal(solver->totals.total);
  }
  PetscCall(EqmDomainCreateVec(domain, &lm->descent));
  PetscCall(VecDuplicate(lm->descent, &lm->mean));
  PetscCall(VecDuplicate(lm->descent, &lm->step));
  PetscCall(VecDuplicate(lm->descent, &lm->curve));
  PetscCall(VecDuplicate(lm->descent, &lm->move));
  PetscCall(VecDuplicate(lm->descent, &lm->solved_mean));
  PetscCall(EqmPlaceCopy(domain, &solver->place, &lm->now.place));
  PetscCall(Evaluate(solver, &lm->now));
  if (PetscIsInfOrNanReal(lm->now.objective)) {
    EqmFail(solver->comm, EQM_ERR_USAGE, "-method lm needs a start without folds, and -start %s has %" PetscInt64_FMT "; take -start guarded", solver->settings.start,
            solver->totals.folds);
  }
  solver->objective = lm->now.objective;
  solver->gradient_norm = -1.;
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmSolver solver)
{
  Lm *const lm = solver->data;

  PetscFunctionBegin;
  PetscCall(EqmLinearDestroy(&lm->linear));
  PetscCall(TrialDestroy(&lm->now));
  PetscCall(TrialDestroy(&lm->best));
  PetscCall(TrialDestroy(&lm->attempt));
  PetscCall(PetscFree3(lm->rate, lm->bend, lm->slope));
  PetscCall(PetscFree3(lm->velocity, lm->acceleration, lm->ambient));
  PetscCall(PetscFree(lm->laplacian));
  PetscCall(VecDestroy(&lm->descent));
  PetscCall(VecDestroy(&lm->mean));
  PetscCall(VecDestroy(&lm->step));
  PetscCall(VecDestroy(&lm->curve));
  PetscCall(VecDestroy(&lm->move));
  PetscCall(VecDestroy(&lm->solved_mean));
  PetscCall(PetscFree(solver->data));
  PetscFunctionReturn(0);
}

const EqmMethod EqmMethodLm = {
    .name = "lm",
    .purpose = "Levenberg-Marquardt on log ratios with geodesic acceleration (METHODS 10, 12)",
    .default_start = "guarded",
    .default_max_it = 60,
    .default_energy_rtol = 1e-2,
    .set_up = SetUp,
    .step = Step,
    .destroy = Destroy,
};
