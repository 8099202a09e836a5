/* Parts of a run's state that have a shape of their own: maps, and vectors of degrees of freedom. */
#include "problem/state.h"
#include "domain/domain_private.h"

/* A map and, on curved domains, its frames. Collective. */
PetscErrorCode EqmStatePlace(EqmState state, EqmDomain domain, const char *name, EqmPlace *place)
{
  char part[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(part, sizeof(part), "%s/coordinates", name));
  PetscCall(EqmStateVertices(state, part, domain->dim, place->x));
  if (!place->frame) PetscFunctionReturn(0);
  PetscCall(PetscSNPrintf(part, sizeof(part), "%s/frames", name));
  PetscCall(EqmStateVertices(state, part, 3, place->frame));
  PetscFunctionReturn(0);
}

/* `dim` numbers per vertex, the first of them its degrees of freedom in its frame, the others zero. Collective. */
PetscErrorCode EqmStateDofs(EqmState state, EqmDomain domain, const char *name, Vec dofs)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt dim = domain->dim;
  PetscReal *local;
  PetscScalar *g;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(dim * mesh->num_local, &local));
  PetscCall(VecGetArray(dofs, &g));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    const PetscScalar *const from = g + domain->dof_start[v] - domain->dof_first;
    for (PetscInt k = 0; k < domain->dof_count[v]; k++) local[dim * v + k] = from[k];
  }
  PetscCall(EqmStateVertices(state, name, dim, local));
  for (PetscInt v = 0; v < mesh->num_owned && EqmStateIsLoading(state); v++) {
    PetscScalar *const to = g + domain->dof_start[v] - domain->dof_first;
    for (PetscInt k = 0; k < domain->dof_count[v]; k++) to[k] = local[dim * v + k];
  }
  PetscCall(VecRestoreArray(dofs, &g));
  PetscCall(PetscFree(local));
  PetscFunctionReturn(0);
}
