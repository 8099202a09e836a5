/* Folds of maps to the ball: the energy with the barrier of barrier.c, first softened until nothing is folded, then as
   a wall of less and less weight, which brings the energy down again. */
#include "unfold/barrier.h"

enum { MOST_ROUNDS = 40, ROUND_STEPS = 15, SETTLE_ROUNDS = 3, SETTLE_STEPS = 60 };
static const PetscReal first_weight = 1e-2, shape_share = .1; /* lambda, and sigma in proportion to it */
static const PetscReal settle_factor = .3; /* of lambda from one round of the second part to the next */
static const PetscReal wall = 1e-12;       /* an epsilon that no cell passes */

/* A map, and how good it is. */
typedef struct {
  EqmPlace place;
  PetscInt64 folds; /* of tetrahedra and boundary triangles */
  PetscReal energy;
} Found;

/* Descend by so many steps of L-BFGS with the barrier as it is, with the pattern of the first time; the objective
   before and after. */
static PetscErrorCode Descend(EqmSolver solver, PetscInt most_steps, PetscReal *before, PetscReal *after)
{
  const PetscInt iterations = solver->iteration;
  EqmStep outcome = EQM_STEP_TAKEN;

  PetscFunctionBegin;
  solver->barrier->shape_weight = shape_share * solver->barrier->weight;
  solver->iteration = 0; /* the method counts from here when its metric is due */
  if (solver->data)
    PetscCall(EqmLbfgsRestart(solver));
  else
    PetscCall(EqmMethodLbfgs.set_up(solver));
  *before = solver->objective;
  while (solver->iteration < most_steps && outcome == EQM_STEP_TAKEN) {
    PetscCall(EqmMethodLbfgs.step(solver, &outcome));
    solver->iteration++;
  }
  *after = solver->objective;
  solver->iteration = iterations;
  PetscFunctionReturn(0);
}

/* Look at the present map, and keep it in `best` if it is better. */
static PetscErrorCode Compare(EqmSolver solver, Found *best, PetscInt64 *folds, PetscReal *least)
{
  PetscFunctionBegin;
  PetscCall(EqmBarrierLook(solver, solver->barrier, least, folds));
  if (*folds > best->folds || (*folds == best->folds && solver->totals.energy >= best->energy)) PetscFunctionReturn(0);
  best->folds = *folds;
  best->energy = solver->totals.energy;
  PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &best->place));
  PetscFunctionReturn(0);
}

/* The next epsilon, which the smallest ratio must have something to gain from: Garanzha and others, section 3, with a
   decrease by 2/5 at least. */
static PetscReal NextEpsilon(PetscReal epsilon, PetscReal least, PetscReal before, PetscReal after)
{
  const PetscReal root = PetscSqrtReal(epsilon * epsilon + least * least);
  const PetscReal chi = least > 0. ? .5 * (least + root) : .5 * epsilon * epsilon / (root - least);
  const PetscReal level = PetscMin(.6, PetscMin(.9, after / before)) * chi;

  return least < level ? PetscMax(wall, 2. * PetscSqrtReal(level * (level - least))) : wall;
}

PetscErrorCode EqmBallUnfold(EqmSolver solver, PetscInt64 *before, PetscInt64 *after)
{
  Found best = {.folds = PETSC_MAX_INT};
  PetscInt64 folds;
  PetscReal least, start = 1., end = 1.;
  EqmBarrier barrier;
  const PetscBool at_end = (PetscBool)(solver->num_history > 0); /* a start is not cut short: it would be another */
  PetscBool stop = PETSC_FALSE;

  PetscFunctionBegin;
  *before = solver->totals.folds;
  PetscCall(EqmPlaceCreate(solver->domain, &best.place));
  PetscCall(EqmBarrierCreate(solver, &barrier));
  solver->barrier = barrier;
  barrier->weight = first_weight;
  PetscCall(Compare(solver, &best, &folds, &least));
  barrier->epsilon = PetscMax(1., -.2 * least);
  for (PetscInt round = 0; round < MOST_ROUNDS && folds > 0 && !stop; round++) {
    PetscCall(Descend(solver, ROUND_STEPS, &start, &end));
    PetscCall(Compare(solver, &best, &folds, &least));
    barrier->epsilon = NextEpsilon(barrier->epsilon, least, start, end);
    if (at_end) PetscCall(EqmCheckpointAskedToStop(solver, &stop));
  }
  barrier->epsilon = wall;
  for (PetscInt round = 0; round < SETTLE_ROUNDS && folds == 0; round++) {
    barrier->weight *= settle_factor;
    PetscCall(Descend(solver, SETTLE_STEPS, &start, &end));
    PetscCall(Compare(solver, &best, &folds, &least));
  }
  PetscCall(EqmMethodLbfgs.destroy(solver));
  PetscCall(EqmBarrierDestroy(&solver->barrier));
  PetscCall(EqmPlaceCopy(solver->domain, &best.place, &solver->place));
  PetscCall(EqmPlaceDestroy(&best.place));
  PetscCall(EqmSolverLook(solver));
  *after = solver->totals.folds;
  PetscFunctionReturn(0);
}
