/* Angle-preserving maps to the sphere are unique up to Mobius maps: which one is it to be? */
#include "method/method.h"

/* The mass centre in the sphere's (004 Definition 2.3). */
static PetscErrorCode Center(EqmSolver solver)
{
  const PetscReal *mass;
  PetscReal offset;

  PetscFunctionBegin;
  PetscCall(EqmVertexMass(solver, &mass));
  PetscCall(EqmPlaceCenter(solver->domain, mass, &solver->place, &offset));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmConformalFinish(EqmSolver solver)
{
  PetscFunctionBegin;
  PetscCall(Center(solver));
  PetscCall(EqmSolverLook(solver));
  PetscFunctionReturn(0);
}
