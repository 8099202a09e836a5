/* The unit disk: the boundary on the circle, the rest free (000 (6), (7)). */
#include "domain/domain_private.h"

PetscErrorCode EqmDomainPlaceOnCircle(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    if (!domain->mesh->on_boundary[v]) continue;
    place->x[2 * v] = PetscCosReal(2. * PETSC_PI * domain->arc_length[v]);
    place->x[2 * v + 1] = PetscSinReal(2. * PETSC_PI * domain->arc_length[v]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateDisk(EqmMesh mesh, EqmDomain *domain)
{

  PetscFunctionBegin;
  PetscCall(EqmDomainCreatePlanar(mesh, "disk", domain));
  (*domain)->motion[0] = &EqmMotionFree;
  (*domain)->motion[1] = &EqmMotionCircle;
  (*domain)->target_measure = PETSC_PI;
  (*domain)->boundary_length = 2. * PETSC_PI;
  (*domain)->place_boundary = EqmDomainPlaceOnCircle;
  for (PetscInt v = 0; v < mesh->num_local; v++) (*domain)->kind[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmDomainNumber(*domain));
  PetscFunctionReturn(0);
}
