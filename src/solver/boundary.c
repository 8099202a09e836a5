/* Where the boundary of a solid goes before its first map: to the sphere within that map, or to the cube before there
   is a domain, which has to know in which faces its vertices are. */
#include "solver/solver_private.h"
#include "mesh/mesh_private.h"
#include <string.h>

static PetscErrorCode MapToCube(void *context, EqmMesh surface, PetscReal *x, PetscInt64 *folds)
{
  const EqmStartOptions *const to_sphere = context;

  PetscFunctionBegin;
  PetscCall(to_sphere->map_surface(to_sphere->context, surface, x, folds));
  PetscCall(EqmCubeFromSphere(surface, x));
  *folds = 0; /* Tutte's maps of the faces have none */
  PetscFunctionReturn(0);
}

/* Those of a box are known; of others they come from the surface's map to the sphere. */
static PetscErrorCode MakePlaces(EqmSolver solver, PetscReal *places)
{
  EqmStartOptions to_cube = solver->settings.start;
  PetscInt64 folds;
  PetscBool is_box;

  PetscFunctionBegin;
  PetscCall(EqmCubeFromBox(solver->mesh, places, &is_box));
  if (is_box) PetscFunctionReturn(0);
  to_cube.map_surface = MapToCube;
  to_cube.context = &solver->settings.start;
  PetscCall(EqmStartPlaceBoundary(solver->mesh, &to_cube, places, &folds));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSolverBoundaryPlaces(EqmSolver solver, EqmMapSurface map_surface, PetscReal **places)
{
  EqmSolverSettings *const set = &solver->settings;

  PetscFunctionBegin;
  *places = NULL;
  set->start.map_surface = map_surface;
  set->start.context = solver;
  if (strcmp(solver->formulation->domain, "cube")) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local, places));
  if (solver->first_map) {
    PetscCall(PetscArraycpy(*places, solver->first_map, 3 * solver->mesh->num_owned));
    PetscCall(EqmMeshUpdateGhosts(solver->mesh, 3, *places));
  } else if (set->restart[0]) {
    PetscCall(EqmCubeFromFile(solver->mesh, set->restart, *places));
  } else if (EqmStartIsFile(set->start.name)) {
    PetscCall(EqmCubeFromFile(solver->mesh, set->start.name, *places));
  } else {
    PetscCall(MakePlaces(solver, *places));
  }
  set->start.map_surface = NULL; /* the domain has them */
  PetscFunctionReturn(0);
}
