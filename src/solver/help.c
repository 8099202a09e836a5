/* All options of a target, without a mesh. */
#include "solver/solver_private.h"
#include "solver/inner.h"

/* Options of the inner solver in the ball's start, which maps the surface to the sphere. */
static PetscErrorCode ListSurfaceOptions(EqmSolver solver)
{
  struct _p_EqmSolver sphere = {.comm = solver->comm, .target = "sphere"};

  PetscFunctionBegin;
  PetscCall(EqmSolverSettingsDefault(&sphere.settings));
  PetscCall(EqmFormulationFind(solver->comm, sphere.target, NULL, &sphere.formulation));
  PetscCall(EqmSolverSetOptionsPrefix(&sphere, EQM_BOUNDARY_PREFIX));
  PetscCall(EqmSolverListOptions(&sphere));
  PetscCall(EqmMethodDestroy(&sphere.method));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverHelp(MPI_Comm comm, const char *target)
{
  struct _p_EqmSolver solver = {.comm = comm};

  PetscFunctionBegin;
  PetscCall(EqmMethodRegisterAll());
  PetscCall(PetscStrncpy(solver.target, target, sizeof(solver.target)));
  PetscCall(EqmSolverSettingsDefault(&solver.settings));
  PetscCall(EqmFormulationFind(comm, target, NULL, &solver.formulation));
  PetscCall(EqmSolverListOptions(&solver));
  PetscCall(EqmMethodDestroy(&solver.method));
  if (solver.formulation->starts == EQM_STARTS_BALL) PetscCall(ListSurfaceOptions(&solver));
  PetscFunctionReturn(0);
}
