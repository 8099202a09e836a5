/* The unit ball: the boundary on the sphere, the rest free in space (003 section 3). */
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

PetscErrorCode EqmDomainTakeSphericalCoordinates(EqmDomain domain)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    if (domain->kind[v] == EQM_VERTEX_SPHERE) domain->kind[v] = EQM_VERTEX_ANGLES;
  }
  domain->spherical_coordinates = PETSC_TRUE;
  PetscFunctionReturn(0);
}

/* 003 (4) and its derivatives. */
void EqmFromAngles(const PetscReal angle[2], PetscReal x[3], PetscReal by_polar[3], PetscReal by_azimuth[3])
{
  const PetscReal s = PetscSinReal(angle[0]), c = PetscCosReal(angle[0]);
  const PetscReal t = PetscSinReal(angle[1]), d = PetscCosReal(angle[1]);
  const PetscReal place[3] = {s * d, s * t, c}, first[3] = {c * d, c * t, -s}, second[3] = {-s * t, s * d, 0.};

  for (PetscInt k = 0; k < 3; k++) {
    if (x) x[k] = place[k];
    if (by_polar) by_polar[k] = first[k];
    if (by_azimuth) by_azimuth[k] = second[k];
  }
}

/* 003 (5). */
void EqmToAngles(const PetscReal x[3], PetscReal angle[2])
{
  angle[0] = PetscAtan2Real(PetscSqrtReal(x[0] * x[0] + x[1] * x[1]), x[2]);
  angle[1] = PetscAtan2Real(x[1], x[0]);
}
