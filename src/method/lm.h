/* The parts of Levenberg-Marquardt on residuals of ratios; lm.c describes the method. */
#ifndef EQM_LM_H
#define EQM_LM_H

#include "method/method.h"
#include "method/pairs.h"
#include "problem/residual.h"

/* A map and what the method minimises there. */
typedef struct {
  EqmPlace place;
  PetscReal *image, *residual; /* per local cell */
  PetscReal squares;           /* sum w rho^2 */
  PetscReal objective;         /* with the added terms; infinite for a map that folds or disorders the boundary */
} EqmTrial;

typedef struct {
  PetscInt most_inner;       /* quasi-Newton steps on each factor, at most */
  const EqmResidual *wanted; /* the user's; NULL: what suits the terms */
  const EqmResidual *residual;
  EqmLinear linear;
  PetscBool by_cycles;     /* on a hierarchy of meshes; else by a factor */
  PetscBool cycles_failed; /* and a factor is what there is since */
  PetscInt image_uses;     /* matrices so far whose coarse motions are interpolated in the map `image_of` */
  EqmPlace image_of;       /* empty before the first */
  PetscReal mu;
  PetscReal term_scale; /* 1/T: of the problem's terms beside sum w rho^2, which is about E/T */
  EqmTerm upright;      /* sphere: the method's own term, of weight kappa T; else NULL */
  PetscReal kappa;
  PetscReal level; /* log A of the residual, held during an iteration; 0 where the mean is removed */
  EqmTrial now, best, attempt;
  PetscReal *slope;                  /* per local cell: d rho / d a */
  PetscReal *rho_first, *rho_second; /* per local cell: first and second derivative of rho along the step */
  PetscReal *velocity, *acceleration, *ambient;
  Vec descent, mean, step, curve, move; /* -b, g, d, d2, t d + t^2 d2 */
  Vec solved_mean;                      /* y = H^-1 g */
  PetscReal mean_product;               /* g.y */
  Vec old_descent, direction;           /* of the quasi-Newton steps */
  Vec part;                             /* what the added terms contribute */
  EqmPairs pairs;
} EqmLm;

/* lm_residual.c */
PETSC_INTERN PetscErrorCode EqmLmAddTerms(EqmMethod method, EqmTrial *trial);
PETSC_INTERN PetscErrorCode EqmLmEvaluate(EqmMethod method, EqmTrial *trial);
/* lm_model.c */
PETSC_INTERN PetscErrorCode EqmLmGradient(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmLmGradientNorm(EqmMethod method, PetscReal *norm);
PETSC_INTERN PetscErrorCode EqmLmLinearise(EqmMethod method, EqmIterate iterate);
PETSC_INTERN PetscErrorCode EqmLmFactor(EqmMethod method, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLmSolveForStep(EqmMethod method, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLmSolveForCurve(EqmMethod method, PetscReal *ratio, PetscBool *success);
PETSC_INTERN PetscErrorCode EqmLmPredictedDecrease(EqmMethod method, PetscReal *decrease);
PETSC_INTERN PetscErrorCode EqmLmApplyInverse(void *method, Vec q);
/* lm_linear.c */
/* Cycles or a factor, as -linear_solver says, and then, once there is a residual, the linear solver. Errors:
   EQM_ERR_USAGE (a hierarchy that there cannot be). Collective. */
PETSC_INTERN PetscErrorCode EqmLmChooseSolver(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmLmCreateLinear(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmLmDestroyLinear(EqmMethod method);
/* Tell it what it wants to know about the map before it gets the map's matrix. Collective. */
PETSC_INTERN PetscErrorCode EqmLmPrepareLinear(EqmMethod method);
/* A factor in place of cycles that lead nowhere. Collective. */
PETSC_INTERN PetscErrorCode EqmLmFallBack(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmLmLinearState(EqmMethod method, EqmState state);
/* lm_fields.c */
PETSC_INTERN PetscErrorCode EqmLmSetFields(EqmMethod method);
/* lm_search.c */
PETSC_INTERN PetscErrorCode EqmLmSearch(EqmMethod method, PetscReal ratio, PetscReal predicted, PetscReal *best_t);
PETSC_INTERN PetscErrorCode EqmLmInnerSteps(EqmMethod method, EqmIterate iterate);
PETSC_INTERN void EqmLmSwap(EqmTrial *a, EqmTrial *b);

/* ---- lm_settings.c */
PETSC_INTERN PetscErrorCode EqmLmSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject);
/* The residual that is wanted, or the one that suits the problem's terms. Collective. */
PETSC_INTERN PetscErrorCode EqmLmChooseResidual(EqmMethod method);

#endif
