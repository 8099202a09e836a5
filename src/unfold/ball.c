/* Folds of maps to the ball: the energy with the barrier of barrier.c, first softened until nothing is folded, then as
   a wall of less and less weight, which brings the energy down again. */
#include "unfold/unfold.h"
#include "method/method.h"
#include "problem/barrier.h"

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
static PetscErrorCode Descend(EqmProblem problem, EqmBarrier barrier, EqmIterate iterate, EqmMethod lbfgs,
                              PetscInt most_steps, PetscReal *before, PetscReal *after)
{
  const PetscInt number = iterate->number;
  EqmStep outcome = EQM_STEP_TAKEN;

  PetscFunctionBegin;
  barrier->shape_weight = shape_share * barrier->weight;
  iterate->number = 0; /* the method counts from here when its metric is due */
  if (lbfgs->is_set_up)
    PetscCall(EqmLbfgsRestart(lbfgs, iterate));
  else
    PetscCall(EqmMethodSetUp(lbfgs, problem, iterate));
  *before = iterate->objective;
  while (iterate->number < most_steps && outcome == EQM_STEP_TAKEN) {
    PetscCall(EqmMethodStep(lbfgs, iterate, &outcome));
    iterate->number++;
  }
  *after = iterate->objective;
  iterate->number = number;
  PetscFunctionReturn(0);
}

/* Inspect the present map, and keep it in `best` if it is better. */
static PetscErrorCode Compare(EqmProblem problem, EqmBarrier barrier, EqmIterate iterate, Found *best,
                              PetscInt64 *folds, PetscReal *least)
{
  PetscFunctionBegin;
  PetscCall(EqmBarrierInspect(barrier, problem, iterate, least, folds));
  if (*folds > best->folds || (*folds == best->folds && iterate->totals.energy >= best->energy)) PetscFunctionReturn(0);
  best->folds = *folds;
  best->energy = iterate->totals.energy;
  PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &best->place));
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

/* L-BFGS as it is for the ball, and as the options have it. */
static PetscErrorCode CreateLbfgs(EqmProblem problem, EqmMethod *lbfgs)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodCreate(problem->comm, "lbfgs", lbfgs));
  PetscCall(EqmLbfgsSetMemory(*lbfgs, 20));
  PetscCall(EqmLbfgsSetLineSearch(*lbfgs, EQM_SEARCH_WOLFE));
  PetscOptionsBegin(problem->comm, problem->prefix, "Unfolding", NULL);
  PetscCall(EqmMethodSetFromOptions(*lbfgs, PetscOptionsObject));
  PetscOptionsEnd();
  PetscFunctionReturn(0);
}

PetscErrorCode EqmBallUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before, PetscInt64 *after)
{
  Found best = {.folds = PETSC_MAX_INT};
  PetscInt64 folds;
  PetscReal least, start = 1., end = 1.;
  PetscBool stop = PETSC_FALSE;
  struct _p_EqmTerm volume;
  EqmBarrier barrier;
  EqmMethod lbfgs;

  PetscFunctionBegin;
  PetscCall(CreateLbfgs(problem, &lbfgs));
  PetscCall(EqmPlaceCreate(problem->domain, &best.place));
  PetscCall(EqmBarrierCreate(problem, &iterate->place, &barrier));
  PetscCall(EqmProblemAddTerm(problem, &barrier->term));
  EqmTermInitVolume(&volume, 1.);
  PetscCall(EqmProblemAddTerm(problem, &volume));
  barrier->weight = first_weight;
  PetscCall(Compare(problem, barrier, iterate, &best, &folds, &least));
  *before = folds;
  barrier->epsilon = PetscMax(1., -.2 * least);
  for (PetscInt round = 0; round < MOST_ROUNDS && folds > 0 && !stop; round++) {
    PetscCall(Descend(problem, barrier, iterate, lbfgs, ROUND_STEPS, &start, &end));
    PetscCall(Compare(problem, barrier, iterate, &best, &folds, &least));
    barrier->epsilon = NextEpsilon(barrier->epsilon, least, start, end);
    PetscCall(EqmProblemStopRequested(problem, &stop));
  }
  barrier->epsilon = wall;
  for (PetscInt round = 0; round < SETTLE_ROUNDS && folds == 0; round++) {
    barrier->weight *= settle_factor;
    PetscCall(Descend(problem, barrier, iterate, lbfgs, SETTLE_STEPS, &start, &end));
    PetscCall(Compare(problem, barrier, iterate, &best, &folds, &least));
  }
  PetscCall(EqmMethodDestroy(&lbfgs));
  PetscCall(EqmProblemRemoveTerm(problem, &barrier->term));
  PetscCall(EqmProblemRemoveTerm(problem, &volume));
  PetscCall(EqmBarrierDestroy(&barrier));
  PetscCall(EqmPlaceCopy(problem->domain, &best.place, &iterate->place));
  PetscCall(EqmPlaceDestroy(&best.place));
  PetscCall(EqmIterateUpdate(problem, iterate));
  *after = best.folds;
  PetscFunctionReturn(0);
}
