/* The conformal energy: how far the Dirichlet energy is above the area, zero for conformal maps alone (004 section 2.1;
   Hutchinson 1991). */
#include <equimap/energy.h>
#include "domain/domain_private.h"
#include "energy/loops.h"

/* 1/2 sum of weight * edge^2 less the image's measure: one small number per cell, which is not negative where the
   weights are the mesh's cotangents. Differences first, sums afterwards. */
static PetscReal ExcessOfRange(EqmMesh mesh, PetscInt dim, const PetscReal *weights, const PetscReal *x,
                               const PetscReal *a, PetscInt b)
{
  PetscReal sum = 0.;

  for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    PetscReal energy = 0.;
    for (PetscInt e = 0; e < 3; e++) {
      const PetscReal *const p = x + dim * v[(e + 1) % 3], *const q = x + dim * v[(e + 2) % 3];
      PetscReal squared = 0.;
      for (PetscInt k = 0; k < dim; k++) squared += PetscSqr(p[k] - q[k]);
      energy += weights[3 * c + e] * squared;
    }
    sum += .5 * energy - a[c];
  }
  return sum;
}

static PetscErrorCode SumExcess(EqmDomain domain, const PetscReal *weights, const EqmPlace *place, const PetscReal *a,
                                PetscReal *energy)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal part[EQM_NUM_RANGES], sum = 0.;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) part[b] = ExcessOfRange(mesh, domain->dim, weights, place->x, a, b);
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum += part[b];
  PetscCall(MPIU_Allreduce(&sum, energy, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* In ambient coordinates: L f - dA/df + m c. */
static PetscErrorCode AmbientGradient(EqmDomain domain, const PetscReal *weights, const PetscReal *mass,
                                      const EqmPlace *place, const PetscReal *center, PetscReal *gradient)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt n = domain->dim * mesh->num_owned;
  PetscReal *slope, *area;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local_cells, &slope, n, &area));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) slope[c] = -1.;
  PetscCall(EqmLaplacianApply(mesh, weights, domain->dim, place->x, gradient));
  PetscCall(EqmImageGradient(domain, place, slope, area));
  for (PetscInt k = 0; k < n; k++)
    gradient[k] += area[k] + (mass ? mass[k / domain->dim] * center[k % domain->dim] : 0.);
  PetscCall(PetscFree2(slope, area));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmConformalEnergy(EqmDomain domain, const PetscReal *weights, const PetscReal *mass,
                                  const EqmPlace *place, PetscReal *a, PetscReal *energy, Vec gradient)
{
  const EqmMesh mesh = domain->mesh;
  PetscReal local[3] = {0., 0., 0.}, center[3] = {0., 0., 0.}, *ambient;

  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(domain, place, a));
  PetscCall(SumExcess(domain, weights, place, a, energy));
  for (PetscInt k = 0; k < domain->dim * mesh->num_owned && mass; k++)
    local[k % domain->dim] += mass[k / domain->dim] * place->x[k];
  if (mass) PetscCall(MPIU_Allreduce(local, center, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) *energy += .5 * center[k] * center[k];
  if (!gradient) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(domain->dim * mesh->num_owned, &ambient));
  PetscCall(AmbientGradient(domain, weights, mass, place, center, ambient));
  PetscCall(EqmDomainProject(domain, place, ambient, gradient));
  PetscCall(PetscFree(ambient));
  PetscFunctionReturn(0);
}
