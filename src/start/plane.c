/* First maps to the disk and the square: boundary by arc length, interior by a Laplacian. */
#include "start/start.h"
#include "domain/domain_private.h"

/* Smallest positive zero of a0 + b t + c t^2, a0 > 0; infinite where there is none. */
static PetscReal FirstZero(PetscReal a0, PetscReal b, PetscReal c)
{
  const PetscReal discriminant = b * b - 4. * a0 * c;
  PetscReal q, t = PETSC_MAX_REAL;

  if (discriminant < 0.) return t;
  q = -.5 * (b + (b >= 0. ? 1. : -1.) * PetscSqrtReal(discriminant));
  if (c != 0. && q / c > 0.) t = q / c;
  if (q != 0. && a0 / q > 0.) t = PetscMin(t, a0 / q);
  return t;
}

PetscErrorCode EqmStepToFold(EqmProblem problem, const EqmPlace *place, const PetscReal *velocity, PetscReal *step)
{
  const EqmMesh mesh = problem->mesh;
  PetscReal *first, *second, *a, local = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_local_cells, &first, mesh->num_local_cells, &second, mesh->num_local_cells, &a));
  PetscCall(EqmImageMeasure(problem->domain, place, a));
  PetscCall(EqmImageDerivatives(problem->domain, place, velocity, NULL, first, second));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    if (a[c] > 0.) local = PetscMin(local, FirstZero(a[c], first[c], .5 * second[c]));
  }
  PetscCall(MPIU_Allreduce(&local, step, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  *step = *step > 1.1 ? 1. : .5 * *step;
  PetscCall(PetscFree3(first, second, a));
  PetscFunctionReturn(0);
}

/* A step towards the harmonic map of L_S(f) with the boundary held, shortened if `guarded` before a cell folds
   (docs/methods.md, Starts). */
static PetscErrorCode FixedPointStep(EqmProblem problem, EqmIterate iterate, PetscBool guarded, PetscReal *weights,
                                     EqmPlace *to)
{
  const PetscInt n = problem->domain->dim * problem->mesh->num_local;
  PetscReal step = 1.;

  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(problem->domain, EQM_LAPLACIAN_STRETCH, &iterate->place, weights));
  PetscCall(EqmHarmonicMap(problem, weights, &iterate->place, to));
  if (guarded) {
    for (PetscInt k = 0; k < n; k++) to->x[k] -= iterate->place.x[k];
    PetscCall(EqmStepToFold(problem, &iterate->place, to->x, &step));
    for (PetscInt k = 0; k < n; k++) to->x[k] = iterate->place.x[k] + step * to->x[k];
  }
  PetscCall(EqmPlaceCopy(problem->domain, to, &iterate->place));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunBoundary(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  (void)options;
  PetscFunctionBegin;
  PetscCall(EqmDomainPlaceBoundary(problem->domain, &iterate->place));
  PetscFunctionReturn(0);
}

/* The harmonic map for the weights of a kind, and fixed-point steps, guarded against folds or not. */
static PetscErrorCode Harmonic(EqmProblem problem, EqmIterate iterate, EqmLaplacianKind kind, PetscBool guarded,
                               PetscInt steps)
{
  PetscReal *weights;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * problem->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(problem->domain, &to));
  PetscCall(EqmDomainPlaceBoundary(problem->domain, &iterate->place));
  PetscCall(EqmLaplacianWeights(problem->domain, kind, &iterate->place, weights));
  PetscCall(EqmHarmonicMap(problem, weights, &iterate->place, &to));
  PetscCall(EqmPlaceCopy(problem->domain, &to, &iterate->place));
  for (PetscInt k = 0; k < steps; k++) PetscCall(FixedPointStep(problem, iterate, guarded, weights, &to));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunCotangent(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscFunctionBegin;
  PetscCall(Harmonic(problem, iterate, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, options->steps));
  PetscFunctionReturn(0);
}

static PetscErrorCode RunUniform(EqmProblem problem, EqmIterate iterate, const EqmStartOptions *options)
{
  PetscFunctionBegin;
  PetscCall(Harmonic(problem, iterate, EQM_LAPLACIAN_UNIFORM, PETSC_TRUE, options->steps));
  PetscFunctionReturn(0);
}

const EqmStartType EqmStartPlaneHarmonic = {EQM_STARTS_PLANE, "harmonic",
                                            "boundary by arc length, interior by cotangent weights", 0, RunCotangent};
const EqmStartType EqmStartPlaneFixedPoint = {
    EQM_STARTS_PLANE, "fixed-point",
    "harmonic, then fixed-point steps with the boundary held (000 Algorithm 1, lines 4-7)", 4, RunCotangent};
const EqmStartType EqmStartPlaneTutte = {EQM_STARTS_PLANE, "tutte",
                                         "boundary by arc length, interior by equal weights: never folds", 0,
                                         RunUniform};
const EqmStartType EqmStartPlaneGuarded = {EQM_STARTS_PLANE, "guarded",
                                           "tutte, then fixed-point steps that stop short of the first fold", 5,
                                           RunUniform};
const EqmStartType EqmStartPlaneArcLength = {
    EQM_STARTS_PLANE, "arc-length",
    "boundary by arc length alone, for methods that put the interior in its place themselves", 0, RunBoundary};
