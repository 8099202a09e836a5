/* The unit ball: the boundary on the sphere, the rest free in space (003 section 3, without its coordinates). */
#include "domain/domain_private.h"

static PetscErrorCode KeepBoundary(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateBall(EqmMesh mesh, EqmDomain *out)
{
  EqmDomain domain;

  PetscFunctionBegin;
  if (mesh->cell_size != 4)
    EqmFail(
        mesh->comm, EQM_ERR_MESH,
        "a map to the ball needs a solid, a mesh of tetrahedra; this is a surface: map it to the disk or the sphere");
  PetscCall(PetscNew(&domain));
  domain->mesh = mesh;
  domain->name = "ball";
  domain->dim = 3;
  domain->measure = EQM_MEASURE_VOLUME;
  domain->kind_of_boundary = EQM_VERTEX_SPHERE;
  domain->target_measure = 4. / 3. * PETSC_PI;
  domain->place_boundary = KeepBoundary;
  PetscCall(PetscMalloc1(mesh->num_local, &domain->kind));
  for (PetscInt v = 0; v < mesh->num_local; v++)
    domain->kind[v] = mesh->on_boundary[v] ? EQM_VERTEX_SPHERE : EQM_VERTEX_FREE;
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
