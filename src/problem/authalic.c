/* The objectives of the area- and volume-preserving maps. */
#include "problem/objective.h"
#include "domain/domain_private.h"

PetscErrorCode EqmSumMeasures(EqmProblem problem, EqmIterate iterate)
{
  PetscReal *scratch;

  PetscFunctionBegin;
  PetscCall(EqmImageSum(problem->mesh, iterate->image, &iterate->totals));
  if (!problem->domain->curved_image) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(problem->mesh->num_local_cells, &scratch));
  PetscCall(EqmImageFolds(problem->domain, &iterate->place, scratch, &iterate->totals.folds));
  PetscCall(PetscFree(scratch));
  PetscFunctionReturn(0);
}

static PetscErrorCode Evaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal *image,
                               PetscReal *value, Vec gradient)
{
  PetscFunctionBegin;
  PetscCall(EqmAuthalicEnergy(problem->domain, place, image, value, gradient));
  PetscFunctionReturn(0);
}

/* Near the minimum the Hessian is about 2/A L_S; on the sphere a tenth of the image's mass keeps the metric definite.
 */
static PetscErrorCode StretchMetric(EqmProblem problem, const EqmPlace *place, PetscReal *weights, PetscReal *mass,
                                    PetscBool *with_mass)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_STRETCH, place, weights));
  *with_mass = problem->domain->curved_image;
  if (*with_mass) {
    PetscCall(EqmImageMeasure(problem->domain, place, mass));
    for (PetscInt c = 0; c < problem->mesh->num_local_cells; c++) mass[c] *= .1 * problem->domain->target_measure;
  }
  PetscFunctionReturn(0);
}

/* The Hessian of sum a^2/(w A) - A but for two rank-one terms by which A couples all cells; A hardly changes. */
static void SetHessian(EqmProblem problem, EqmIterate iterate, PetscInt cell, const EqmCellDerivatives *d,
                       PetscReal *matrix)
{
  const EqmImageTotals *const totals = &iterate->totals;
  const PetscReal share = problem->mesh->weight[cell] * totals->total, scale = 2. / share;
  const PetscReal slope = 2. * (iterate->image[cell] / share - 1.) - totals->energy / totals->total;

  for (PetscInt i = 0; i < d->frame.count; i++) {
    for (PetscInt j = 0; j < d->frame.count; j++)
      matrix[d->frame.count * i + j] = scale * d->first[i] * d->first[j] + slope * d->second[i][j];
  }
}

/* A poor map has ratios off by half, root mean square: that is none of equal areas. */
const EqmObjective EqmObjectiveAuthalic = {.name = "authalic",
                                           .sum = EqmSumMeasures,
                                           .poor_energy = .25,
                                           .evaluate = Evaluate,
                                           .set_hessian = SetHessian,
                                           .of_ratios = PETSC_TRUE,
                                           .metric = StretchMetric,
                                           .inverse_scale = .5};
