/* Domains: the common part. There is a file per manifold, which has the motion of a kind of vertex, and a file per
   domain, which has its kinds. */
#include "domain/domain_private.h"
#include "geometry/simplex.h"

/* The frame of one vertex; returns its number of degrees of freedom. Not collective. */
PetscInt EqmDomainFrame(EqmDomain domain, const EqmPlace *place, PetscInt v, PetscReal frame[9])
{
  const EqmVertexMotion *const motion = EqmDomainMotion(domain, v);

  if (domain->dof_count[v] > 0)
    motion->frame(domain->dim, place->x + domain->dim * v, place->frame ? place->frame + 3 * v : NULL, frame);
  return domain->dof_count[v];
}

/* Number the degrees of freedom once `kind` is known: each rank's in the order of its vertices. Collective. */
PetscErrorCode EqmDomainNumber(EqmDomain domain)
{
  const EqmMesh mesh = domain->mesh;
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local, &domain->dof_start, mesh->num_local, &domain->dof_count));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscInt dofs = EqmDomainMotion(domain, v)->num_dofs;
    domain->dof_count[v] = (unsigned char)(dofs == EQM_DOFS_OF_SPACE ? domain->dim : dofs);
    if (v < mesh->num_owned) {
      domain->dof_start[v] = count;
      count += domain->dof_count[v];
    }
  }
  domain->num_dofs = count;
  domain->dof_first = 0;
  PetscCallMPI(MPI_Exscan(&count, &domain->dof_first, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (mesh->rank == 0) domain->dof_first = 0;
  for (PetscInt v = 0; v < mesh->num_owned; v++) domain->dof_start[v] += domain->dof_first;
  PetscCall(
      PetscSFBcastBegin(mesh->halo, MPIU_INT, domain->dof_start, domain->dof_start + mesh->num_owned, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(mesh->halo, MPIU_INT, domain->dof_start, domain->dof_start + mesh->num_owned, MPI_REPLACE));
  PetscFunctionReturn(0);
}

/* A domain without vertices' kinds yet, with the arc length of the boundary. Collective. */
PetscErrorCode EqmDomainCreatePlanar(EqmMesh mesh, const char *name, EqmDomain *out)
{
  EqmDomain domain;
  PetscInt *order; /* along the loop */

  PetscFunctionBegin;
  PetscCall(PetscNew(&domain));
  domain->mesh = mesh;
  domain->name = name;
  domain->dim = 2;
  PetscCall(PetscCalloc1(mesh->num_local, &domain->kind));
  PetscCall(PetscMalloc1(mesh->num_local, &domain->arc_length));
  PetscCall(PetscMalloc1(mesh->num_local, &order));
  PetscCall(EqmMeshBoundaryLoop(mesh, order, domain->arc_length));
  PetscCall(PetscFree(order));
  *out = domain;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmDomainDestroy(EqmDomain *domain)
{
  PetscFunctionBegin;
  if (!*domain) PetscFunctionReturn(0);
  PetscCall(PetscFree((*domain)->kind));
  PetscCall(PetscFree((*domain)->arc_length));
  PetscCall(PetscFree((*domain)->boundary_place));
  PetscCall(PetscFree2((*domain)->dof_start, (*domain)->dof_count));
  PetscCall(PetscFree(*domain));
  PetscFunctionReturn(0);
}

/* All places zero. Not collective. */
PetscErrorCode EqmPlaceCreate(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(domain->dim * domain->mesh->num_local, &place->x));
  place->frame = NULL;
  if (domain->has_frames) PetscCall(PetscCalloc1(3 * domain->mesh->num_local, &place->frame));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPlaceDestroy(EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(place->x));
  PetscCall(PetscFree(place->frame));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPlaceCopy(EqmDomain domain, const EqmPlace *from, EqmPlace *to)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(to->x, from->x, domain->dim * domain->mesh->num_local));
  if (from->frame) PetscCall(PetscArraycpy(to->frame, from->frame, 3 * domain->mesh->num_local));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCreateVec(EqmDomain domain, Vec *v)
{
  PetscFunctionBegin;
  PetscCall(VecCreateMPI(domain->mesh->comm, domain->num_dofs, PETSC_DECIDE, v));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainMove(EqmDomain domain, const EqmPlace *from, PetscReal t, Vec step, EqmPlace *to)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt dim = domain->dim;
  const PetscScalar *s;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(step, &s));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    EqmDomainMotion(domain, v)->retract(dim, from->x + dim * v, from->frame ? from->frame + 3 * v : NULL, t,
                                        s + domain->dof_start[v] - domain->dof_first, to->x + dim * v,
                                        to->frame ? to->frame + 3 * v : NULL);
  }
  PetscCall(VecRestoreArrayRead(step, &s));
  PetscCall(EqmMeshUpdateGhosts(mesh, dim, to->x));
  if (to->frame) PetscCall(EqmMeshUpdateGhosts(mesh, 3, to->frame));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPlaceMakeFrames(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  for (PetscInt v = 0; v < domain->mesh->num_local && place->frame; v++) {
    const EqmVertexMotion *const motion = EqmDomainMotion(domain, v);
    if (motion->choose_frame) motion->choose_frame(place->x + 3 * v, place->frame + 3 * v);
  }
  PetscFunctionReturn(0);
}

/* In the place of what `dofs` has, or added to it. */
static PetscErrorCode Project(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient, PetscBool add,
                              Vec dofs)
{
  PetscScalar *g;

  PetscFunctionBegin;
  PetscCall(VecGetArray(dofs, &g));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(domain, place, v, frame);
    for (PetscInt k = 0; k < count; k++) {
      PetscScalar *const to = &g[domain->dof_start[v] - domain->dof_first + k];
      PetscReal sum = 0.;
      for (PetscInt c = 0; c < domain->dim; c++) sum += frame[domain->dim * k + c] * ambient[domain->dim * v + c];
      *to = add ? *to + sum : sum;
    }
  }
  PetscCall(VecRestoreArray(dofs, &g));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainProject(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient, Vec dofs)
{
  PetscFunctionBegin;
  PetscCall(Project(domain, place, ambient, PETSC_FALSE, dofs));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainAddProjected(EqmDomain domain, const EqmPlace *place, const PetscReal *ambient, Vec dofs)
{
  PetscFunctionBegin;
  PetscCall(Project(domain, place, ambient, PETSC_TRUE, dofs));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainExpandOwned(EqmDomain domain, const EqmPlace *place, Vec dofs, PetscReal *ambient)
{
  const PetscScalar *g;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(dofs, &g));
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_owned; v++) {
    PetscReal frame[9];
    const PetscInt count = EqmDomainFrame(domain, place, v, frame);
    for (PetscInt c = 0; c < domain->dim; c++) {
      PetscReal sum = 0.;
      for (PetscInt k = 0; k < count; k++)
        sum += frame[domain->dim * k + c] * g[domain->dof_start[v] - domain->dof_first + k];
      ambient[domain->dim * v + c] = sum;
    }
  }
  PetscCall(VecRestoreArrayRead(dofs, &g));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainExpand(EqmDomain domain, const EqmPlace *place, Vec dofs, PetscReal *ambient)
{
  PetscFunctionBegin;
  PetscCall(EqmDomainExpandOwned(domain, place, dofs, ambient));
  PetscCall(EqmMeshUpdateGhosts(domain->mesh, domain->dim, ambient));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainCurvature(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                  PetscReal *acceleration)
{
  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt v = 0; v < domain->mesh->num_local; v++) {
    const PetscReal *const u = velocity + domain->dim * v;
    const PetscReal curvature = EqmDomainMotion(domain, v)->curvature;
    PetscReal squared = 0.;
    for (PetscInt c = 0; c < domain->dim && curvature > 0.; c++) squared += u[c] * u[c];
    for (PetscInt c = 0; c < domain->dim; c++)
      acceleration[domain->dim * v + c] = -curvature * squared * place->x[domain->dim * v + c];
  }
  PetscFunctionReturn(0);
}

void EqmDomainSumBoundary(EqmDomain domain, const EqmPlace *place, PetscReal sum[EQM_BOUNDARY_SUMS])
{
  const EqmMesh mesh = domain->mesh;

  sum[0] = sum[1] = 0.;
  if (domain->boundary_length == 0.) return;
  for (PetscInt e = 0; e < mesh->num_boundary_facets; e++) {
    const PetscInt i = mesh->boundary_facets[2 * e], j = mesh->boundary_facets[2 * e + 1];
    if (i >= mesh->num_owned) continue;
    const PetscReal advance = EqmDomainMotion(domain, i)->advance(place->x + 2 * i, place->x + 2 * j);
    sum[0] += advance;
    sum[1] += !(advance > 0.);
  }
}

PetscBool EqmDomainIsInOrder(EqmDomain domain, const PetscReal sum[EQM_BOUNDARY_SUMS])
{
  if (domain->boundary_length == 0.) return PETSC_TRUE;
  return (PetscBool)(sum[1] == 0. && PetscAbsReal(sum[0] - domain->boundary_length) < .5);
}

PetscErrorCode EqmDomainBoundaryInOrder(EqmDomain domain, const EqmPlace *place, PetscBool *in_order)
{
  PetscReal sum[EQM_BOUNDARY_SUMS];

  PetscFunctionBegin;
  *in_order = PETSC_TRUE;
  if (domain->boundary_length == 0.) PetscFunctionReturn(0);
  EqmDomainSumBoundary(domain, place, sum);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, EQM_BOUNDARY_SUMS, MPIU_REAL, MPIU_SUM, domain->mesh->comm));
  *in_order = EqmDomainIsInOrder(domain, sum);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainPlaceBoundary(EqmDomain domain, EqmPlace *place)
{
  PetscFunctionBegin;
  PetscCall(domain->place_boundary(domain, place));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmDomainGetDimension(EqmDomain domain, PetscInt *dim)
{
  PetscFunctionBegin;
  *dim = domain->dim;
  PetscFunctionReturn(0);
}
