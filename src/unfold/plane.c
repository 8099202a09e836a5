/* Folds of maps to the plane that are good elsewhere: around them, and further around where that is not enough,
   vertices go to the mean of their neighbours, the others and the boundary held. At the last all inner vertices do,
   which folds nowhere where the boundary is convex (Tutte 1963). */
#include "unfold/unfold.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"

enum { FARTHEST = 256 };

/* Mark all that is within `reach` cells of a fold. Collective. */
static PetscErrorCode MarkAround(EqmMesh mesh, const PetscReal *image, PetscInt reach, PetscReal *marked)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(marked, mesh->num_local));
  for (PetscInt ring = 0; ring < reach; ring++) {
    PetscReal *const next = marked + mesh->num_local;
    PetscCall(PetscArraycpy(next, marked, mesh->num_local));
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
      const PetscInt *const v = mesh->cells + 3 * c;
      const PetscBool near =
          (PetscBool)(ring == 0 ? !(image[c] > 0.) : marked[v[0]] + marked[v[1]] + marked[v[2]] > 0.);
      for (PetscInt a = 0; a < 3 && near; a++) next[v[a]] = 1.;
    }
    PetscCall(PetscArraycpy(marked, next, mesh->num_local));
    PetscCall(EqmMeshUpdateGhosts(mesh, 1, marked));
  }
  PetscFunctionReturn(0);
}

/* Which vertices are solved for: free ones near the folds, or all that are free. */
static PetscErrorCode Group(EqmProblem problem, const PetscReal *image, PetscInt reach, PetscReal *marked,
                            signed char *group)
{
  const EqmMesh mesh = problem->mesh;

  PetscFunctionBegin;
  if (reach <= FARTHEST) PetscCall(MarkAround(mesh, image, reach, marked));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscBool held = (PetscBool)(EqmDomainMotion(problem->domain, v) != &EqmMotionFree);
    group[v] = held || (reach <= FARTHEST && marked[v] == 0.) ? EQM_GROUP_FIXED : 0;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaneUnfold(EqmProblem problem, EqmIterate iterate, PetscInt64 *before, PetscInt64 *after)
{
  const EqmMesh mesh = problem->mesh;
  const PetscInt num_cells = mesh->num_local_cells;
  PetscReal *weights, *marked, *image;
  signed char *group;
  EqmPlace trial;

  PetscFunctionBegin;
  PetscCall(
      PetscMalloc4(3 * num_cells, &weights, num_cells, &image, 2 * mesh->num_local, &marked, mesh->num_local, &group));
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_UNIFORM, NULL, weights));
  PetscCall(EqmPlaceCreate(problem->domain, &trial));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, iterate->image, before));
  *after = *before;
  for (PetscInt reach = 1; *after > 0 && reach <= 2 * FARTHEST; reach *= 2) {
    PetscInt64 folds;
    PetscCall(Group(problem, iterate->image, reach, marked, group));
    PetscCall(EqmPlaceCopy(problem->domain, &iterate->place, &trial));
    PetscCall(EqmHeldSolve(problem, weights, group, 2, trial.x));
    PetscCall(EqmImageFolds(problem->domain, &trial, image, &folds));
    if (folds >= *after) continue;
    *after = folds;
    PetscCall(EqmPlaceCopy(problem->domain, &trial, &iterate->place));
    PetscCall(PetscArraycpy(iterate->image, image, num_cells));
  }
  PetscCall(EqmPlaceDestroy(&trial));
  PetscCall(PetscFree4(weights, image, marked, group));
  PetscCall(EqmIterateUpdate(problem, iterate));
  PetscFunctionReturn(0);
}
