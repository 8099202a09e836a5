/* A term that holds the volume of the image: (T - A)^2 / T, A the image's volume and T the target's. With it the energy
   is close to that without normalisation, sum a^2/w - 2 A + T, which no map lowers by losing volume. */
#include "unfold/unfold.h"
#include "domain/domain_private.h"

static PetscErrorCode Add(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                          PetscReal *value, Vec gradient)
{
  const EqmMesh mesh = problem->mesh;
  const PetscReal target = problem->domain->target_measure;
  PetscReal *slope, *ambient;
  EqmImageTotals totals;

  PetscFunctionBegin;
  PetscCall(EqmImageSum(mesh, image, &totals));
  *value += term->weight * PetscSqr(target - totals.total) / target;
  if (!gradient) PetscFunctionReturn(0);
  PetscCall(PetscMalloc2(mesh->num_local_cells, &slope, problem->domain->dim * mesh->num_owned, &ambient));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) slope[c] = -2. * term->weight * (target - totals.total) / target;
  PetscCall(EqmImageGradient(problem->domain, place, slope, ambient));
  PetscCall(EqmDomainAddProjected(problem->domain, place, ambient, gradient));
  PetscCall(PetscFree2(slope, ambient));
  PetscFunctionReturn(0);
}

void EqmTermInitVolume(EqmTerm term, PetscReal weight)
{
  *term = (struct _p_EqmTerm){.name = "volume", .weight = weight, .add = Add};
}
