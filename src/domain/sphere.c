/* The unit sphere: every vertex on it (001 section 2). */
#include "domain/domain_private.h"

static PetscErrorCode NoBoundary(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateSphere(EqmMesh mesh, EqmDomain *out)
{
  EqmDomain domain;

  PetscFunctionBegin;
  if (mesh->num_boundary_vertices > 0) {
    EqmFail(mesh->comm, EQM_ERR_MESH,
            "a map to the sphere needs a closed surface; this one has %" PetscInt_FMT
            " boundary vertices: map it to the disk, or close its holes",
            mesh->num_boundary_vertices);
  }
  PetscCall(PetscNew(&domain));
  domain->mesh = mesh;
  domain->name = "sphere";
  domain->dim = 3;
  domain->measure = EQM_MEASURE_AREA3;
  domain->curved_image = PETSC_TRUE;
  domain->motion[0] = &EqmMotionSphere;
  domain->has_frames = PETSC_TRUE;
  domain->target_measure = 4. * PETSC_PI;
  domain->place_boundary = NoBoundary;
  PetscCall(PetscCalloc1(mesh->num_local, &domain->kind));
  PetscCall(EqmDomainNumber(domain));
  *out = domain;
  PetscFunctionReturn(0);
}
