/* Metrics (preconditioners) for descent: they turn gradients of the objective into directions. */
#ifndef EQM_METRIC_H
#define EQM_METRIC_H

#include "problem/problem.h"
#include "problem/state.h"

typedef struct _p_EqmMetric *EqmMetric;
PETSC_INTERN PetscErrorCode EqmMetricCreate(EqmProblem problem, EqmMetric *metric);
PETSC_INTERN PetscErrorCode EqmMetricDestroy(EqmMetric *metric);
/* Take the Laplacian that suits the problem's objective at a map; nothing to do where it is fixed and has been taken.
   Counts a factorisation. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricRefresh(EqmMetric metric, const EqmPlace *place);
/* h = M^-1 g; both in degrees of freedom at the given map; may be the same. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricApply(EqmMetric metric, const EqmPlace *place, Vec g, Vec h);
/* Is it applied as a cycle of multigrid, whose set-up takes as long as some eight iterations? Not collective. */
PETSC_INTERN PetscBool EqmMetricIsCycle(EqmMetric metric);
/* For the `state` of a method that keeps a metric over several steps. Collective. */
PETSC_INTERN PetscErrorCode EqmMetricState(EqmMetric metric, EqmState state);

#endif
