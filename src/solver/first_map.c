/* The map that iterations begin with, unless a checkpoint has it. */
#include "solver/solver_private.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

/* In deep tubes the areas of Tutte's map vanish in rounding, and it folds though it cannot: another
   start takes its place, which goes from coarse to fine. */
static PetscErrorCode TakeCascade(EqmSolver solver)
{
  const EqmStartType *cascade;
  PetscBool guarded;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(solver->start->name, "guarded", &guarded));
  if (!guarded || solver->formulation->starts != EQM_STARTS_PLANE) PetscFunctionReturn(0);
  PetscCall(EqmIterateUpdate(solver->problem, solver->iterate));
  if (solver->iterate->totals.folds == 0) PetscFunctionReturn(0);
  PetscCall(EqmProblemNotify(solver->problem,
                             "the start guarded has %" PetscInt64_FMT " folds, areas below rounding: cascade instead\n",
                             solver->iterate->totals.folds));
  PetscCall(EqmStartFind(solver->comm, solver->formulation->starts, solver->target, "cascade", &cascade));
  PetscCall(EqmStartRun(cascade, solver->problem, solver->iterate, &solver->settings.start));
  PetscFunctionReturn(0);
}

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
  PetscCall(TakeCascade(solver));
  PetscFunctionReturn(0);
}
