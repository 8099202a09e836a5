/* A boundary that is held where the first map has it: 000 section 6 has h_B = R f_B. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include "solver/inner.h"

PetscErrorCode EqmSolverHoldBoundary(EqmSolver solver)
{
  PetscFunctionBegin;
  solver->settings.hold_boundary = PETSC_TRUE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverGetMethodName(EqmSolver solver, const char **name)
{
  PetscFunctionBegin;
  *name = solver->defaults.name;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverHeldAngles(EqmSolver solver, PetscReal **angles)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal *angle;

  PetscFunctionBegin;
  *angles = NULL;
  if (!solver->settings.hold_boundary || !solver->first_map) PetscFunctionReturn(0);
  PetscCall(PetscCalloc1(mesh->num_local + 1, &angle)); /* not NULL on ranks without vertices */
  for (PetscInt v = 0; v < mesh->num_owned; v++)
    angle[v] = PetscAtan2Real(solver->first_map[2 * v + 1], solver->first_map[2 * v]);
  PetscCall(EqmMeshUpdateGhosts(mesh, 1, angle));
  *angles = angle;
  PetscFunctionReturn(0);
}
