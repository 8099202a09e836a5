/* The unit disk: the boundary on the circle, the rest free (000 (6), (7)). */
#include "domain/domain_private.h"

static PetscErrorCode PlaceOnCircle(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    if (domain->kind[v] != EQM_VERTEX_CIRCLE) continue;
    place->x[2 * v] = PetscCosReal(2. * PETSC_PI * domain->arc_length[v]);
    place->x[2 * v + 1] = PetscSinReal(2. * PETSC_PI * domain->arc_length[v]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateDisk(EqmMesh mesh, EqmDomain *domain)
{
  PetscInt *loop_place;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreatePlanar(mesh, "disk", domain, &loop_place));
  PetscCall(PetscFree(loop_place));
  (*domain)->kind_of_boundary = EQM_VERTEX_CIRCLE;
  (*domain)->target_measure = PETSC_PI;
  (*domain)->boundary_length = 2. * PETSC_PI;
  (*domain)->place_boundary = PlaceOnCircle;
  for (PetscInt v = 0; v < mesh->num_local; v++)
    (*domain)->kind[v] = mesh->on_boundary[v] ? EQM_VERTEX_CIRCLE : EQM_VERTEX_FREE;
  PetscCall(EqmDomainNumber(*domain));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainPlaceBoundary(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(domain->place_boundary(domain, place));
  PetscFunctionReturn(0);
}
