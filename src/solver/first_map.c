/* The map that iterations begin with, unless a checkpoint has it. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

PetscErrorCode EqmSolverMakeFirstMap(EqmSolver solver)
{
  const EqmDomain domain = solver->problem->domain;
  EqmPlace *const place = &solver->iterate->place;

  PetscFunctionBegin;
  if (solver->first_map) {
    PetscCheck(solver->first_map_dim == domain->dim, solver->comm, PETSC_ERR_ARG_INCOMP,
               "a first map has the target's coordinates");
    PetscCall(PetscArraycpy(place->x, solver->first_map, domain->dim * solver->mesh->num_owned));
    PetscCall(EqmMeshUpdateGhosts(solver->mesh, domain->dim, place->x));
    PetscCall(EqmPlaceMakeFrames(domain, place));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmStartRun(solver->start, solver->problem, solver->iterate, &solver->settings.start));
  PetscFunctionReturn(0);
}
