/* Newton's method on an objective with second derivatives and its terms, damped after Levenberg and Marquardt in the
   objective's metric.

   On the sphere flat triangles can tip over, which lowers the energy and leads to folds. From a map without folds the
   upright term is added there as the barrier of an interior-point method: its weight falls by a factor whenever a step
   gains little (Nocedal and Wright, Numerical Optimization, 2006, chapter 19). Begun with a large weight, the way leads
   through short upright triangles, and past the local minima in which long ones are jammed. */
#include "method/method.h"
#include "domain/domain_private.h"
#include "energy/curvature.h"

enum { MOST_DAMPINGS = 40 };
/* The damping's metric has constants and rotations in its null space: a little of its diagonal keeps it definite. */
static const PetscReal diagonal_share = 1e-8;
/* The barrier's weight falls by this factor once a step lowers the objective by less than that part; it has done so
   when its share of the energy is negligible. */
static const PetscReal weight_factor = .3, least_gain = 1e-3, negligible = 1e-6;

typedef struct {
  PetscReal first_barrier; /* on the sphere: the weight to begin with, per target's measure; 0: none */
  EqmTerm barrier;         /* NULL: none */
  EqmLinear linear;
  PetscReal mu;
  PetscReal *weights, *mass; /* of the metric's Laplacian; the mass is left out */
  PetscReal *image, *velocity;
  EqmPlace trial;
  Vec gradient, trial_gradient, step;
} Newton;

/* ---- barrier */

static PetscErrorCode CreateBarrier(EqmMethod method, EqmIterate iterate)
{
  Newton *const newton = method->data;
  const EqmDomain domain = method->problem->domain;

  PetscFunctionBegin;
  if (domain->measure != EQM_MEASURE_AREA3 || newton->first_barrier == 0. || iterate->totals.folds > 0)
    PetscFunctionReturn(0);
  PetscCall(EqmTermCreateUpright(method->problem, newton->first_barrier * domain->target_measure, &newton->barrier));
  PetscCall(EqmProblemAddTerm(method->problem, newton->barrier));
  PetscFunctionReturn(0);
}

static PetscErrorCode DestroyBarrier(EqmMethod method)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  if (!newton->barrier) PetscFunctionReturn(0);
  PetscCall(EqmProblemRemoveTerm(method->problem, newton->barrier));
  PetscCall(newton->barrier->destroy(newton->barrier));
  newton->barrier = NULL;
  PetscFunctionReturn(0);
}

/* Objective and gradient at the present map. */
static PetscErrorCode Evaluate(EqmMethod method, EqmIterate iterate)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  PetscCall(EqmProblemEvaluate(method->problem, iterate, &iterate->place, iterate->image, &iterate->objective,
                               newton->gradient));
  PetscCall(VecNorm(newton->gradient, NORM_2, &iterate->gradient_norm));
  PetscFunctionReturn(0);
}

/* Is the barrier more than a rounding of the energy? Collective. */
static PetscErrorCode BarrierCounts(EqmMethod method, EqmIterate iterate, PetscBool *counts)
{
  Newton *const newton = method->data;
  PetscReal part = 0.;

  PetscFunctionBegin;
  *counts = PETSC_FALSE;
  if (!newton->barrier) PetscFunctionReturn(0);
  PetscCall(newton->barrier->add(newton->barrier, method->problem, &iterate->place, iterate->image, &part, NULL));
  *counts = (PetscBool)(part > PetscMax(negligible * iterate->totals.energy,
                                        PETSC_MACHINE_EPSILON * method->problem->domain->target_measure));
  PetscFunctionReturn(0);
}

static PetscErrorCode LowerBarrier(EqmMethod method, EqmIterate iterate)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  newton->barrier->weight *= weight_factor;
  PetscCall(Evaluate(method, iterate));
  PetscFunctionReturn(0);
}

/* ---- steps */

static PetscErrorCode SetUp(EqmMethod method, EqmIterate iterate)
{
  const EqmMesh mesh = method->problem->mesh;
  const EqmDomain domain = method->problem->domain;
  Newton *const newton = method->data;

  PetscFunctionBegin;
  newton->mu = 1e-2;
  PetscCall(EqmProblemCreateLinear(method->problem, EQM_MATRIX_COUPLED, &newton->linear));
  PetscCall(PetscMalloc4(EqmCellNumEdges(mesh->cell_size) * mesh->num_local_cells, &newton->weights,
                         mesh->num_local_cells, &newton->mass, mesh->num_local_cells, &newton->image,
                         domain->dim * mesh->num_local, &newton->velocity));
  PetscCall(EqmPlaceCreate(domain, &newton->trial));
  PetscCall(EqmDomainCreateVec(domain, &newton->gradient));
  PetscCall(VecDuplicate(newton->gradient, &newton->trial_gradient));
  PetscCall(VecDuplicate(newton->gradient, &newton->step));
  PetscCall(CreateBarrier(method, iterate));
  PetscCall(Evaluate(method, iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(EqmMethod method)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  PetscCall(DestroyBarrier(method));
  PetscCall(EqmLinearDestroy(&newton->linear));
  PetscCall(PetscFree4(newton->weights, newton->mass, newton->image, newton->velocity));
  PetscCall(EqmPlaceDestroy(&newton->trial));
  PetscCall(VecDestroy(&newton->gradient));
  PetscCall(VecDestroy(&newton->trial_gradient));
  PetscCall(VecDestroy(&newton->step));
  PetscFunctionReturn(0);
}

static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmMethod method = context;
  const EqmIterate iterate = method->iterate;
  const EqmProblem problem = method->problem;
  const EqmMesh mesh = problem->mesh;
  const Newton *const newton = method->data;
  PetscReal laplacian[4][4];
  EqmCellDerivatives d;

  EqmCellDifferentiate(problem->domain, &iterate->place, cell, &d);
  EqmCellLaplacian(mesh->cell_size, newton->weights + EqmCellNumEdges(mesh->cell_size) * cell, laplacian);
  for (PetscInt a = 0; a < mesh->cell_size; a++) laplacian[a][a] *= 1. + diagonal_share;
  problem->objective->set_hessian(problem, iterate, cell, &d, matrix);
  EqmTermsAddMatrix(problem, &iterate->place, iterate->image, cell, &d.frame, 2., matrix);
  EqmCellFrameAddLaplacian(&d.frame, newton->mu, laplacian, matrix);
}

/* (H + mu M) p = -g; what the quadratic model without the damping promises. An iteration finds only here that a matrix
   is not definite. */
static PetscErrorCode SolveStep(EqmMethod method, EqmIterate iterate, PetscReal *promised, PetscBool *success)
{
  Newton *const newton = method->data;
  PetscReal slope, metric;
  PetscScalar *p;

  PetscFunctionBegin;
  PetscCall(VecCopy(newton->gradient, newton->step));
  PetscCall(VecScale(newton->step, -1.));
  PetscCall(VecGetArray(newton->step, &p));
  PetscCall(EqmLinearTrySolve(newton->linear, 1, p, p, success));
  PetscCall(VecRestoreArray(newton->step, &p));
  if (!*success) PetscFunctionReturn(0);
  PetscCall(VecDot(newton->gradient, newton->step, &slope));
  PetscCall(EqmDomainExpand(method->problem->domain, &iterate->place, newton->step, newton->velocity));
  PetscCall(EqmLaplacianEnergy(method->problem->mesh, newton->weights, method->problem->domain->dim, newton->velocity,
                               &metric));
  *promised = -.5 * slope + newton->mu * metric; /* the metric's energy is half p^T M p */
  PetscFunctionReturn(0);
}

/* `gain`: the decrease over what was promised. */
static PetscErrorCode AcceptTrial(EqmMethod method, EqmIterate iterate, PetscReal energy, PetscReal gain)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  PetscCall(EqmIterateAccept(method->problem, iterate, &newton->trial, newton->image, energy, 1.));
  PetscCall(VecCopy(newton->trial_gradient, newton->gradient));
  PetscCall(VecNorm(newton->gradient, NORM_2, &iterate->gradient_norm));
  if (gain > .75) newton->mu = PetscMax(.25 * newton->mu, 1e-12);
  if (gain < .25) newton->mu *= 3.;
  PetscFunctionReturn(0);
}

/* Steps with ever more damping until one decreases the objective. */
static PetscErrorCode TryDampings(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Newton *const newton = method->data;
  PetscReal promised, energy;

  PetscFunctionBegin;
  *outcome = EQM_STEP_STALLED;
  for (PetscInt damping = 0; damping < MOST_DAMPINGS; damping++, newton->mu = PetscMax(4. * newton->mu, 1e-10)) {
    PetscBool success;
    PetscCall(EqmLinearFactor(newton->linear, CellMatrix, method, 1., &success));
    if (success) PetscCall(SolveStep(method, iterate, &promised, &success));
    if (!success) continue;
    if (promised <= 1e-13 * iterate->objective) { /* what is left is rounding */
      *outcome = EQM_STEP_CONVERGED;
      PetscFunctionReturn(0);
    }
    PetscCall(EqmDomainMove(method->problem->domain, &iterate->place, 1., newton->step, &newton->trial));
    PetscCall(
        EqmProblemEvaluate(method->problem, iterate, &newton->trial, newton->image, &energy, newton->trial_gradient));
    const PetscReal gain = (iterate->objective - energy) / promised;
    if (!(gain > 1e-4)) continue;
    PetscCall(AcceptTrial(method, iterate, energy, gain));
    *outcome = EQM_STEP_TAKEN;
    PetscFunctionReturn(0);
  }
  PetscFunctionReturn(0);
}

/* A step of the iteration is one that moves the map, with as low a barrier as that takes. */
static PetscErrorCode Step(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  Newton *const newton = method->data;
  PetscReal before;
  PetscBool with_mass, lower;

  PetscFunctionBegin;
  PetscCall(
      method->problem->objective->metric(method->problem, &iterate->place, newton->weights, newton->mass, &with_mass));
  do {
    const PetscReal mu = newton->mu;
    before = iterate->objective;
    PetscCall(TryDampings(method, iterate, outcome));
    lower = (PetscBool)(*outcome != EQM_STEP_TAKEN || before - iterate->objective < least_gain * before);
    if (lower) PetscCall(BarrierCounts(method, iterate, &lower));
    if (lower) PetscCall(LowerBarrier(method, iterate));
    if (lower && *outcome == EQM_STEP_STALLED) newton->mu = mu;
  } while (lower && *outcome != EQM_STEP_TAKEN);
  PetscFunctionReturn(0);
}

/* A barrier of no weight is none. */
static PetscErrorCode State(EqmMethod method, EqmIterate iterate, EqmState state)
{
  Newton *const newton = method->data;
  PetscReal weight = newton->barrier ? newton->barrier->weight : 0.;

  PetscFunctionBegin;
  PetscCall(EqmStateReal(state, "mu", &newton->mu));
  PetscCall(EqmStateReal(state, "barrier_weight", &weight));
  if (!EqmStateIsLoading(state)) PetscFunctionReturn(0);
  if (weight == 0.) PetscCall(DestroyBarrier(method));
  if (newton->barrier) newton->barrier->weight = weight;
  PetscCall(Evaluate(method, iterate));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  Newton *const newton = method->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-newton_barrier",
                             "newton, sphere: first weight of what keeps triangles upright, which falls in the course "
                             "of the run; 30 shortens long triangles first",
                             "EqmSolverSetFromOptions", newton->first_barrier, &newton->first_barrier, NULL));
  if (!(newton->first_barrier >= 0.))
    EqmFail(method->comm, EQM_ERR_USAGE, "-newton_barrier %.6g: give 0 or more", (double)newton->first_barrier);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmNewtonSetBarrier(EqmMethod method, PetscReal weight)
{
  PetscFunctionBegin;
  ((Newton *)method->data)->first_barrier = weight;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreateNewton(EqmMethod method)
{
  Newton *newton;

  PetscFunctionBegin;
  PetscCall(PetscNew(&newton));
  newton->first_barrier = .01;
  method->data = newton;
  method->purpose =
      "damped Newton steps with the exact Hessian: a coupled factorisation each, for up to 100,000 vertices";
  method->takes_terms = method->needs_hessian = PETSC_TRUE;
  method->ops =
      (EqmMethodOps){.set_from_options = SetFromOptions, .set_up = SetUp, .step = Step, .state = State, .reset = Reset};
  PetscFunctionReturn(0);
}
