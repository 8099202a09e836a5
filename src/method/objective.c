/* The objectives of the area- and volume-preserving maps. */
#include "method/method.h"
#include "unfold/barrier.h"

PetscErrorCode EqmSumMeasures(EqmSolver solver)
{
  PetscReal *scratch;

  PetscFunctionBegin;
  PetscCall(EqmImageSum(solver->mesh, solver->image, &solver->totals));
  if (!solver->domain->curved_image) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(solver->mesh->num_local_cells, &scratch));
  PetscCall(EqmImageFolds(solver->domain, &solver->place, scratch, &solver->totals.folds));
  PetscCall(PetscFree(scratch));
  PetscFunctionReturn(0);
}

/* With the barrier against folds, while there is one. */
static PetscErrorCode Evaluate(EqmSolver solver, const EqmPlace *place, PetscReal *image, PetscReal *value,
                               Vec gradient)
{
  PetscFunctionBegin;
  PetscCall(EqmAuthalicEnergy(solver->domain, place, image, value, gradient));
  if (solver->barrier) PetscCall(EqmBarrierAdd(solver, solver->barrier, place, image, value, gradient));
  PetscFunctionReturn(0);
}

/* Near the minimum the Hessian is about 2/A L_S; on the sphere a tenth of the image's mass keeps the metric definite.
 */
static PetscErrorCode StretchMetric(EqmSolver solver, PetscReal *weights, PetscReal *mass, PetscBool *with_mass)
{
  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(solver->domain, EQM_LAPLACIAN_STRETCH, &solver->place, weights));
  *with_mass = solver->domain->curved_image;
  if (*with_mass) {
    PetscCall(EqmImageMeasure(solver->domain, &solver->place, mass));
    for (PetscInt c = 0; c < solver->mesh->num_local_cells; c++) mass[c] *= .1 * solver->domain->target_measure;
  }
  PetscFunctionReturn(0);
}

/* A poor map has ratios off by half, root mean square: that is none of equal areas. */
const EqmObjective EqmObjectiveAuthalic = {
    .sum = EqmSumMeasures, .poor_energy = .25, .evaluate = Evaluate, .metric = StretchMetric, .inverse_scale = .5};
