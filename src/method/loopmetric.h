/* The Steklov operator of a disk's boundary loop, as a metric for functions on the loop. */
#ifndef EQM_LOOPMETRIC_H
#define EQM_LOOPMETRIC_H

#include "method/loop.h"

typedef struct _p_EqmLoopMetric *EqmLoopMetric;
/* From the places on the unit circle (two reals per local vertex, in order). The loop must outlive it. Collective. */
PETSC_INTERN PetscErrorCode EqmLoopMetricCreate(EqmLoop loop, const PetscReal *x, EqmLoopMetric *metric);
PETSC_INTERN PetscErrorCode EqmLoopMetricDestroy(EqmLoopMetric *metric);
/* h = S^-1 g, one real per owned boundary vertex; may be the same array. Collective. */
PETSC_INTERN PetscErrorCode EqmLoopMetricApply(EqmLoopMetric metric, const PetscReal *g, PetscReal *h);

#endif
