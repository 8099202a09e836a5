/* Angle-preserving maps: the Dirichlet energy; and for those of closed surfaces the objective E_D - A + |c|^2/2, its
   metric, its step limit. The last term fixes the mass centre c: Mobius maps change the first two terms only by the
   discretisation error, so that without it the iterates would drift. */
#include "problem/objective.h"
#include "domain/domain_private.h"

/* The totals of the areas with the Dirichlet energy 1/2 tr f^T L f, L with the mesh's cotangent weights. */
static PetscErrorCode SumDirichlet(EqmProblem problem, EqmIterate iterate)
{
  const PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(EqmSumMeasures(problem, iterate));
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(
      EqmLaplacianEnergy(problem->mesh, weights, problem->domain->dim, iterate->place.x, &iterate->totals.energy));
  PetscFunctionReturn(0);
}

/* A trial that folds is rejected where the iterate does not fold: its value is infinite. */
static PetscErrorCode Evaluate(EqmProblem problem, EqmIterate iterate, const EqmPlace *place, PetscReal *image,
                               PetscReal *value, Vec gradient)
{
  const PetscReal *weights, *mass;
  PetscInt64 folds = 0;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &weights));
  PetscCall(EqmProblemGetVertexMass(problem, &mass));
  if (iterate->totals.folds == 0) PetscCall(EqmImageFolds(problem->domain, place, image, &folds));
  PetscCall(EqmConformalEnergy(problem->domain, weights, mass, place, image, value, gradient));
  if (folds > 0) *value = INFINITY;
  PetscFunctionReturn(0);
}

/* L + M with the mesh's cotangents, M the mass in units of the sphere's area. */
static PetscErrorCode CotangentMetric(EqmProblem problem, const EqmPlace *place, PetscReal *weights, PetscReal *mass,
                                      PetscBool *with_mass)
{
  const PetscReal *cotangents;

  PetscFunctionBegin;
  PetscCall(EqmProblemGetAngleWeights(problem, &cotangents));
  PetscCall(PetscArraycpy(weights, cotangents, 3 * problem->mesh->num_local_cells));
  for (PetscInt c = 0; c < problem->mesh->num_local_cells; c++)
    mass[c] = problem->domain->target_measure * problem->mesh->weight[c];
  *with_mass = PETSC_TRUE;
  PetscFunctionReturn(0);
}

/* Are all Bernstein coefficients of c0 + c1 t + c2 t^2 + c3 t^3 on [from, to] positive? They bound its values. */
static PetscBool IsPositive(const PetscReal c[4], PetscReal from, PetscReal to)
{
  const PetscReal h = to - from, v0 = c[0] + from * (c[1] + from * (c[2] + from * c[3]));
  const PetscReal v1 = h * (c[1] + from * (2. * c[2] + 3. * from * c[3])), v2 = h * h * (c[2] + 3. * from * c[3]);

  return (PetscBool)(v0 > 0. && v0 + v1 / 3. > 0. && v0 + 2. * v1 / 3. + v2 / 3. > 0. &&
                     v0 + v1 + v2 + h * h * h * c[3] > 0.);
}

/* A time in (0, most] up to which the cubic is positive: its first zero, or a little less. */
static PetscReal PositiveUpTo(const PetscReal c[4], PetscReal most)
{
  enum { HALVINGS = 20 };
  PetscReal from = 0., to = most;

  if (IsPositive(c, 0., most)) return most;
  for (PetscInt k = 0; k < HALVINGS; k++) {
    const PetscReal middle = .5 * (from + to);
    if (IsPositive(c, from, middle))
      from = middle;
    else
      to = middle;
  }
  return from;
}

/* .8 of the first zero of a determinant along the tangents; the determinants are cubic there. Cells that are folded now
   do not count. */
static PetscErrorCode StepToFold(EqmProblem problem, EqmIterate iterate, Vec direction, PetscReal *t)
{
  const EqmDomain domain = problem->domain;
  const EqmMesh mesh = problem->mesh;
  const PetscInt m = mesh->num_local_cells;
  const PetscReal share = .8;
  PetscReal *det, *first, *second, *third, local = 1. / share;
  EqmPlace velocity = {0};

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(3 * mesh->num_local, &velocity.x, m, &det, m, &first, m, &second, m, &third));
  PetscCall(EqmDomainExpand(domain, &iterate->place, direction, velocity.x));
  PetscCall(EqmImageMeasureOf(domain, EQM_MEASURE_HALF_DET, &iterate->place, det));
  PetscCall(EqmImageDerivativesOf(domain, EQM_MEASURE_HALF_DET, &iterate->place, velocity.x, NULL, first, second));
  PetscCall(EqmImageMeasureOf(domain, EQM_MEASURE_HALF_DET, &velocity, third));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    const PetscReal cubic[4] = {det[c], first[c], .5 * second[c], third[c]};
    if (det[c] > 0.) local = PetscMin(local, PositiveUpTo(cubic, local));
  }
  PetscCall(PetscFree5(velocity.x, det, first, second, third));
  PetscCall(MPIU_Allreduce(&local, t, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  *t *= share;
  PetscFunctionReturn(0);
}

const EqmObjective EqmObjectiveConformal = {.name = "conformal",
                                            .sum = SumDirichlet,
                                            .evaluate = Evaluate,
                                            .metric = CotangentMetric,
                                            .fixed_metric = PETSC_TRUE,
                                            .inverse_scale = 1. / (4. * PETSC_PI),
                                            .longest_step = StepToFold};
