/* Angle-preserving maps of closed surfaces with thin limbs. A limb of length l and girth g shrinks by exp(-2 pi l / g):
   triangles of area 1e-20 on the sphere are common, and in double precision the sign of their determinants depends on
   rounding. */
#include "start/start.h"
#include "domain/domain_private.h"

/* Limbs get a conductivity that falls towards their tips, a power of the conformal map's local scale, where the
   logarithm of the scale is below `first_scale`. Along a limb the harmonic map then shrinks less: with the power 2
   lambda the exponent is multiplied by sqrt(lambda^2 + 1) - lambda. Weights remain positive, so that Tutte's theorem
   still holds.
 */
static const PetscReal first_scale = -6., power_step = .1;

/* Logarithm of the scale at which the present map has each cell, averaged over neighbours. */
static PetscErrorCode FindScales(EqmProblem problem, EqmIterate iterate, PetscReal *scale)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *sum;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * mesh->num_local, &sum));
  PetscCall(EqmImageMeasureOf(problem->domain, EQM_MEASURE_HALF_DET, &iterate->place, scale));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscReal image = PetscMax(PetscAbsReal(scale[c]), PETSC_SQRT_MACHINE_EPSILON * EqmSmallestImage);
    for (PetscInt a = 0; a < 3; a++) {
      PetscReal *const s = sum + 2 * mesh->cells[3 * c + a];
      s[0] += mesh->weight[c] * .5 * PetscLogReal(image / (problem->domain->target_measure * mesh->weight[c]));
      s[1] += mesh->weight[c];
    }
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, sum));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    scale[c] = 0.;
    for (PetscInt a = 0; a < 3; a++) {
      const PetscReal *const s = sum + 2 * mesh->cells[3 * c + a];
      scale[c] += s[0] / s[1] / 3.;
    }
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

/* Solve for one cap, then the opposite one, and so on, for as long as the Dirichlet energy of the angle weights falls:
   a few rounds remove the errors of the linear map around its pinned triangle. */
static PetscErrorCode ImproveByCaps(EqmProblem problem, EqmIterate iterate)
{
  enum { MOST_STEPS = 20 };
  const PetscReal least_fall = 1e-6;
  const PetscReal *weights;
  PetscReal energy, before = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  for (PetscInt k = 0; k < MOST_STEPS; k++) {
    PetscCall(EqmSphereCapStep(problem, iterate, k, weights));
    PetscCall(EqmLaplacianEnergy(problem->mesh, weights, 3, iterate->place.x, &energy));
    if (before - energy < least_fall * energy) break;
    before = energy;
  }
  PetscCall(EqmIterateCenter(problem, iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSphereResolved(EqmProblem problem, EqmIterate iterate)
{
  enum { FIRST_POWER = 3, MOST_POWER = 20 };
  const PetscInt n = problem->mesh->num_local_cells;
  const PetscReal *weights;
  PetscReal *scale, *cotangents, smallest;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &scale, 3 * n, &cotangents));
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(PetscArraycpy(cotangents, weights, 3 * n));
  PetscCall(EqmSphereLinear(problem, iterate, PETSC_FALSE));
  PetscCall(ImproveByCaps(problem, iterate));
  PetscCall(FindScales(problem, iterate, scale));
  PetscCall(EqmSphereSmallestImage(problem, &iterate->place, &smallest));
  for (PetscInt power = FIRST_POWER; power <= MOST_POWER && smallest < EqmSmallestImage; power++) {
    for (PetscInt k = 0; k < 3 * n; k++) {
      const PetscReal below = PetscMin(0., scale[k / 3] - first_scale);
      problem->angle_weights[k] = cotangents[k] * PetscExpReal(2. * power_step * power * below);
    }
    PetscCall(ImproveByCaps(problem, iterate));
    PetscCall(EqmSphereSmallestImage(problem, &iterate->place, &smallest));
  }
  PetscCall(PetscFree2(scale, cotangents));
  PetscFunctionReturn(0);
}

static PetscErrorCode Run(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmSphereResolved(problem, iterate));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartSphereResolved = {
    EQM_STARTS_SPHERE, "resolved",
    "harmonic with the cotangents, cap by cap; limbs kept from shrinking below what the arithmetic resolves", 0, Run};
