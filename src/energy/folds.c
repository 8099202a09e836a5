/* Counts of folded simplices of an image. */
#include <equimap/energy.h>
#include "domain/domain_private.h"
#include "geometry/simplex.h"

PetscErrorCode EqmImageFolds(EqmDomain domain, const EqmPlace *place, PetscReal *scratch, PetscInt64 *folds)
{
  const EqmMesh mesh = domain->mesh;
  PetscInt64 count = 0;

  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(domain, domain->curved_image ? EQM_MEASURE_HALF_DET : domain->measure, place, scratch));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) count += !(scratch[c] > 0.);
  PetscCall(MPIU_Allreduce(&count, folds, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageBoundaryFolds(EqmDomain domain, const EqmPlace *place, PetscInt64 *folds)
{
  const EqmMesh mesh = domain->mesh;
  PetscInt64 count = 0;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscInt lowest = v[0]; /* its owner counts the triangle */
    for (PetscInt a = 1; a < 3; a++) lowest = mesh->global[v[a]] < mesh->global[lowest] ? v[a] : lowest;
    if (lowest >= mesh->num_owned) continue;
    PetscReal from_center[9];
    for (PetscInt k = 0; k < 9; k++) from_center[k] = place->x[3 * v[k / 3] + k % 3] - domain->center[k % 3];
    count += !(EqmHalfDet(from_center, from_center + 3, from_center + 6) > 0.);
  }
  PetscCall(MPIU_Allreduce(&count, folds, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscFunctionReturn(0);
}
