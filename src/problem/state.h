/* The state of a method: what its next step takes over from the steps before, beyond the present map.

   A method fills in the operation `state` of its EqmMethod (method.h), one function for saving and loading:

       static PetscErrorCode State(EqmSolver solver, EqmState state)
       {
         Ncg *const ncg = solver->data;

         PetscFunctionBegin;
         PetscCall(EqmStateReal(state, "alpha", &ncg->alpha));
         PetscCall(EqmStateDofs(state, solver->domain, "direction", ncg->direction));
         PetscCall(EqmMetricState(solver, ncg->metric, state));
         PetscFunctionReturn(0);
       }

   When a run is restarted, `set_up` is called first, with map, iteration, totals and history as they were; the map is
   then set again, should set_up have moved it; then comes `state`. So what set_up derives from the present map
   (gradients, residuals) need not be named. What depends on the past must be: directions, damping, pairs, the map that
   an old factor belongs to. Factors themselves are not kept: name the place where the matrix was made and, if
   EqmStateIsLoading, factor again there. Objective, gradient norm, step length and the counters of work are set back
   afterwards: nothing is counted twice. A method without a memory leaves `state` NULL.

   A first map (-start) is not made again: what it leaves in the solver beside the map would be lost.

   A restarted run on as many ranks goes on bit for bit, so a value that is recomputed must have the same bits as the
   one that was lost; where in doubt, name it. */
#ifndef EQM_METHOD_STATE_H
#define EQM_METHOD_STATE_H

#include "store/state.h"
#include <equimap/domain.h>

PETSC_INTERN PetscErrorCode EqmStatePlace(EqmState state, EqmDomain domain, const char *name, EqmPlace *place);
PETSC_INTERN PetscErrorCode EqmStateDofs(EqmState state, EqmDomain domain, const char *name, Vec dofs);

#endif
