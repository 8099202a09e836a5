/* The unit ball: the boundary on the sphere, the rest free in space (003 section 3). */
#include "domain/domain_private.h"

static PetscErrorCode KeepBoundary(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateBall(EqmMesh mesh, PetscBool angles, EqmDomain *out)
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
  domain->motion[0] = &EqmMotionFree;
  domain->motion[1] = angles ? &EqmMotionAngles : &EqmMotionSphere;
  domain->has_frames = PETSC_TRUE;
  domain->spherical_coordinates = angles;
  domain->target_measure = 4. / 3. * PETSC_PI;
  domain->place_boundary = KeepBoundary;
  PetscCall(PetscMalloc1(mesh->num_local, &domain->kind));
  for (PetscInt v = 0; v < mesh->num_local; v++) domain->kind[v] = mesh->on_boundary[v] ? 1 : 0;
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
