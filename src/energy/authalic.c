/* The normalised authalic energy (000 (4)): zero if and only if every cell keeps its share of the total. */
#include <equimap/energy.h>
#include "domain/domain_private.h"

PetscErrorCode EqmAuthalicEnergy(EqmDomain domain, const EqmPlace *place, PetscReal *a, PetscReal *energy, Vec gradient)
{
  const EqmMesh mesh = domain->mesh;
  EqmImageTotals totals;
  PetscReal *slope, *ambient;

  PetscFunctionBegin;
  PetscCall(EqmImageMeasure(domain, place, a));
  PetscCall(EqmImageSum(mesh, a, &totals));
  *energy = totals.total > 0. ? totals.energy : INFINITY;
  if (!gradient) PetscFunctionReturn(0);
  PetscCall(PetscMalloc2(mesh->num_local_cells, &slope, domain->dim * mesh->num_owned, &ambient));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    slope[c] = 2. * (a[c] / (mesh->weight[c] * totals.total) - 1.) - totals.energy / totals.total;
  }
  PetscCall(EqmImageGradient(domain, place, slope, ambient));
  PetscCall(EqmDomainProject(domain, place, ambient, gradient));
  PetscCall(PetscFree2(slope, ambient));
  PetscFunctionReturn(0);
}
