/* Methods: iterations that improve a map.

   A method is one file. Its create function fills in the operations and a settings structure of its own with defaults;
   EqmMethodRegister registers it by name. The problem and the iterate that it works on come with EqmMethodSetUp. */
#ifndef EQM_METHOD_H
#define EQM_METHOD_H

#include "problem/problem.h"
#include "problem/residual.h"
#include "problem/metric.h"
#include "problem/objective.h"
#include "problem/state.h"
#include "problem/term.h"

/* The outcome of a step. */
typedef enum {
  EQM_STEP_TAKEN,
  EQM_STEP_CONVERGED, /* the method's own test is met */
  EQM_STEP_STALLED    /* no step decreases the function any more */
} EqmStep;

typedef struct _p_EqmMethod *EqmMethod;

typedef struct {
  PetscErrorCode (*set_from_options)(EqmMethod, PetscOptionItems *); /* may be NULL */
  /* Set up for the first step; the iterate holds the first map, its image and totals. Sets objective and gradient
     norm (-1: unknown). */
  PetscErrorCode (*set_up)(EqmMethod, EqmIterate);
  /* One step: updates place, image, totals, step length, gradient norm and objective of the iterate. */
  PetscErrorCode (*step)(EqmMethod, EqmIterate, EqmStep *);
  PetscErrorCode (*state)(EqmMethod, EqmIterate,
                          EqmState);    /* what a checkpoint holds beside the map: state.h; or NULL */
  PetscErrorCode (*reset)(EqmMethod);   /* free what set_up made; may be NULL */
  PetscErrorCode (*destroy)(EqmMethod); /* free what create made; NULL: PetscFree(data) */
} EqmMethodOps;

struct _p_EqmMethod {
  MPI_Comm comm;
  char name[32];
  const char *purpose; /* one-line description */
  EqmMethodOps ops;
  EqmProblem problem;        /* NULL before EqmMethodSetUp */
  EqmIterate iterate;        /* the one that is worked on, for callbacks */
  PetscBool goes_on;         /* the run has an energy to reach or to stand still at: the method's own idea of enough,
                                if it has one, does not count */
  PetscReal energy_target;   /* the energy that the run is to reach, for methods that can aim at it; 0: none */
  PetscBool takes_landmarks; /* it draws the problem's landmarks, though it takes no terms */
  PetscBool takes_terms;     /* it minimises the problem's added terms with the leading one */
  /* What the leading term must have: be least where all ratios are one; second derivatives. */
  PetscBool needs_ratios, needs_hessian;
  PetscBool is_set_up;
  void *data;                    /* the method's own: settings and work space */
  char message[EQM_MESSAGE_MAX]; /* why there is no further step; empty: nothing special */
};

/* Register a method: `create` fills in purpose, operations and data of a new one. Not collective. */
PETSC_EXTERN PetscErrorCode EqmMethodRegister(const char *name, PetscErrorCode (*create)(EqmMethod));
/* Register the methods of this folder, except where others are registered under their names (methods.c). Not
   collective. */
PETSC_INTERN PetscErrorCode EqmMethodRegisterAll(void);
/* Is there a method of this name? Not collective. */
PETSC_INTERN PetscErrorCode EqmMethodIsRegistered(const char *name, PetscBool *is);
/* Is it registered, and not one of the library's own? Not collective. */
PETSC_INTERN PetscErrorCode EqmMethodIsForeign(const char *name, PetscBool *foreign);
/* Errors: EQM_ERR_USAGE (no such method). Collective. */
PETSC_INTERN PetscErrorCode EqmMethodCreate(MPI_Comm comm, const char *name, EqmMethod *method);
PETSC_INTERN PetscErrorCode EqmMethodDestroy(EqmMethod *method);
/* Between PetscOptionsBegin and PetscOptionsEnd. Collective. */
PETSC_INTERN PetscErrorCode EqmMethodSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject);
/* Set up for the first step from the iterate; may be called again to restart from another. Collective. */
PETSC_INTERN PetscErrorCode EqmMethodSetUp(EqmMethod method, EqmProblem problem, EqmIterate iterate);
/* One step. Collective. */
PETSC_INTERN PetscErrorCode EqmMethodStep(EqmMethod method, EqmIterate iterate, EqmStep *outcome);
/* Save or load the state that the next step depends on. Collective. */
PETSC_INTERN PetscErrorCode EqmMethodVisitState(EqmMethod method, EqmIterate iterate, EqmState state);
/* Free work space; settings stay. Collective. */
PETSC_INTERN PetscErrorCode EqmMethodReset(EqmMethod method);

/* The create functions of the methods of this folder. */
PETSC_INTERN PetscErrorCode EqmMethodCreateFixedPoint(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateNcg(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateLbfgs(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateRgd(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateLm(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateNewton(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateCascade(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateRiemann(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateCovering(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateCoveringExplicit(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateCoveringImplicit(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateQiem(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateEulerExplicit(EqmMethod method);
PETSC_INTERN PetscErrorCode EqmMethodCreateEulerImplicit(EqmMethod method);

/* ---- settings that depend on the target (lbfgs.c, lm_settings.c, newton.c) */
typedef enum { EQM_SEARCH_ARMIJO, EQM_SEARCH_WOLFE } EqmLbfgsLineSearch;
PETSC_INTERN PetscErrorCode EqmLbfgsSetMemory(EqmMethod lbfgs, PetscInt memory);
PETSC_INTERN PetscErrorCode EqmLbfgsSetLineSearch(EqmMethod lbfgs, EqmLbfgsLineSearch search);
/* Restart at the present map, whose objective may have changed: without pairs, with a metric from here. Collective.
 */
PETSC_INTERN PetscErrorCode EqmLbfgsRestart(EqmMethod lbfgs, EqmIterate iterate);
/* Newton on the sphere: the barrier's first weight. Not collective. */
PETSC_INTERN PetscErrorCode EqmNewtonSetBarrier(EqmMethod newton, PetscReal weight);
/* At most so many quasi-Newton steps on each factor. */
PETSC_INTERN PetscErrorCode EqmLmSetInnerSteps(EqmMethod lm, PetscInt steps);
/* The residual from the next set-up on; NULL: the one that suits the problem. Not collective. */
PETSC_INTERN PetscErrorCode EqmLmSetResidual(EqmMethod lm, const EqmResidual *residual);
/* Has lm squared logarithms because that suits the problem, and not because the user wants them? Not collective. */
PETSC_INTERN PetscErrorCode EqmLmIsByLogarithms(EqmMethod lm, PetscBool *is);

#endif
