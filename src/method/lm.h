/* The parts of Levenberg-Marquardt on log ratios; what it does is told in lm.c. */
#ifndef EQM_LM_H
#define EQM_LM_H

#include "method/method.h"
#include "method/pairs.h"

/* The residual of a map and what it adds up to. */
typedef struct {
  EqmPlace place;
  PetscReal *image, *residual; /* per local cell */
  PetscReal squares;           /* sum w rho^2 */
  PetscReal *half_det, *lean;  /* sphere: half the determinant of each image triangle, q = log(half_det / a) */
  PetscReal barrier;           /* sphere: sum w q^2 */
  PetscReal angle;             /* E_D - A, if the angle energy has a weight */
  PetscReal pull;              /* sum |x - q|^2 over the landmarks */
  PetscReal objective;         /* with the angle energy; infinite for a map that folds or disorders the boundary */
} EqmTrial;

typedef struct {
  PetscInt most_inner; /* quasi-Newton steps on each factor, at most */
  EqmLinear linear;
  PetscReal mu, epsilon, angle_weight; /* angle_weight: eps / T */
  PetscReal kappa;                     /* sphere: weight of the barrier; else 0 */
  PetscReal level;                     /* balanced: log A, held during an iteration */
  EqmTrial now, best, attempt;
  PetscReal *laplacian;             /* cotangent weights of the mesh, if epsilon > 0 */
  PetscReal *lean_rate, *lean_bend; /* sphere: the same of q */
  PetscReal *rate, *bend, *slope;   /* per local cell: d rho along the step; second derivative; d rho / d a */
  PetscReal *velocity, *acceleration, *ambient;
  Vec descent, mean, step, curve, move; /* -b, g, d, d2, t d + t^2 d2 */
  Vec solved_mean;                      /* y = H^-1 g */
  Vec old_descent, direction;           /* of the quasi-Newton steps */
  EqmPairs pairs;
} EqmLm;

/* rho and its first two derivatives by l = log((a/w)/A). */
static inline void EqmLmResidual(PetscBool balanced, PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second)
{
  const PetscBool stretched = (PetscBool)(balanced && l > 0.);
  *rho = stretched ? PetscExpReal(l) - 1. : l;
  *first = stretched ? PetscExpReal(l) : 1.;
  *second = stretched ? PetscExpReal(l) : 0.;
}

/* lm_residual.c */
PETSC_INTERN PetscErrorCode EqmLmWeightedSum(EqmMesh mesh, const PetscReal *x, PetscInt power, PetscReal *sum);
PETSC_INTERN PetscErrorCode EqmLmRemoveMean(EqmMesh mesh, PetscReal *x);
PETSC_INTERN PetscErrorCode EqmLmAngleEnergy(EqmMethod method, const PetscReal *x, PetscReal *energy);
PETSC_INTERN void EqmLmWeigh(EqmMethod method, EqmTrial *trial);
PETSC_INTERN PetscErrorCode EqmLmEvaluate(EqmMethod method, EqmTrial *trial);
/* lm_model.c */
PETSC_INTERN PetscErrorCode EqmLmGradient(EqmMethod method, EqmIterate iterate);
PETSC_INTERN PetscErrorCode EqmLmLinearise(EqmMethod method, EqmIterate iterate);
PETSC_INTERN PetscErrorCode EqmLmFactor(EqmMethod method, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLmSolveForStep(EqmMethod method, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLmSolveForCurve(EqmMethod method, PetscReal *ratio);
PETSC_INTERN PetscErrorCode EqmLmPredictedDecrease(EqmMethod method, PetscReal *decrease);
PETSC_INTERN PetscErrorCode EqmLmApplyInverse(void *method, Vec q);
/* lm_fields.c */
PETSC_INTERN PetscErrorCode EqmLmSetFields(EqmMethod method);
/* lm_search.c */
PETSC_INTERN PetscErrorCode EqmLmSearch(EqmMethod method, PetscReal ratio, PetscReal predicted, PetscReal *best_t);
PETSC_INTERN PetscErrorCode EqmLmInnerSteps(EqmMethod method, EqmIterate iterate);
PETSC_INTERN void EqmLmSwap(EqmTrial *a, EqmTrial *b);

#endif
