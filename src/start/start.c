/* First maps. */
#include "method/method.h"

typedef struct StartRow StartRow;
struct StartRow {
  const char *name, *purpose;
  EqmStartFamily family;
  PetscErrorCode (*run)(EqmSolver, const StartRow *, PetscInt steps);
  EqmLaplacianKind laplacian;
  PetscBool guarded; /* planar: fixed-point steps are cut short before the first fold */
  PetscInt steps;    /* fixed-point steps unless -start_steps says otherwise */
};

static PetscErrorCode StartBoundary(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartInPlane(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartOnSphere(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartGuarded(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartDescending(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartConformal(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartResolved(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartGauss(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartTutteOnSphere(EqmSolver, const StartRow *, PetscInt);
static PetscErrorCode StartInBall(EqmSolver, const StartRow *, PetscInt);

static const StartRow starts[] = {
    {"harmonic", "boundary by arc length, interior by cotangent weights", EQM_STARTS_PLANE, StartInPlane,
     EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"fixed-point", "harmonic, then fixed-point steps with the boundary held (000 Algorithm 1, lines 4-7)",
     EQM_STARTS_PLANE, StartInPlane, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 4},
    {"tutte", "boundary by arc length, interior by equal weights: never folds", EQM_STARTS_PLANE, StartInPlane,
     EQM_LAPLACIAN_UNIFORM, PETSC_TRUE, 0},
    {"guarded", "tutte, then fixed-point steps that stop short of the first fold", EQM_STARTS_PLANE, StartInPlane,
     EQM_LAPLACIAN_UNIFORM, PETSC_TRUE, 5},
    {"arc-length", "boundary by arc length alone, for methods that put the interior in its place themselves",
     EQM_STARTS_PLANE, StartBoundary, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"linear", "Laplacian linearisation: one triangle pinned, the rest conformal", EQM_STARTS_SPHERE, StartOnSphere,
     EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"fixed-point", "linear, then fixed-point steps (001 Algorithm 2)", EQM_STARTS_SPHERE, StartOnSphere,
     EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 10},
    {"descending", "linear, then fixed-point steps for as long as the energy falls, seven at most (001 section 6.3)",
     EQM_STARTS_SPHERE, StartDescending, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 7},
    {"guarded", "linear; where it folds or shrinks limbs to points, fixed-point steps and unfolding, or tutte",
     EQM_STARTS_SPHERE, StartGuarded, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 15},
    {"conformal", "linear, then the Mobius map that brings its mass centre to the sphere's", EQM_STARTS_SPHERE,
     StartConformal, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"resolved",
     "harmonic with the cotangents, cap by cap; limbs kept from shrinking below what the arithmetic resolves",
     EQM_STARTS_SPHERE, StartResolved, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"normals", "vertex normals (004 Definition 5.1): folds wherever the surface is hollow", EQM_STARTS_SPHERE,
     StartGauss, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"gauss", "normals, smoothed by heat flow for as long as they fold, and unfolding", EQM_STARTS_SPHERE, StartGauss,
     EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 20},
    {"tutte", "two hemispheres, each by equal weights, and unfolding (004 section 5.1)", EQM_STARTS_SPHERE,
     StartTutteOnSphere, EQM_LAPLACIAN_UNIFORM, PETSC_FALSE, 0},
    {"harmonic", "boundary area-preserving on the sphere, interior harmonic", EQM_STARTS_BALL, StartInBall,
     EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 0},
    {"fixed-point", "harmonic, then fixed-point steps with the boundary held (003 section 4)", EQM_STARTS_BALL,
     StartInBall, EQM_LAPLACIAN_COTANGENT, PETSC_FALSE, 4},
};
enum { NUM_STARTS = sizeof(starts) / sizeof(starts[0]) };

static PetscErrorCode FindRow(const EqmProblem *problem, const char *name, const StartRow **row)
{
  char names[EQM_MESSAGE_MAX];

  PetscFunctionBegin;
  for (int k = 0; k < NUM_STARTS; k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(name, starts[k].name, &same));
    if (!same || starts[k].family != problem->starts) continue;
    *row = &starts[k];
    PetscFunctionReturn(0);
  }
  PetscCall(EqmStartNames(problem->starts, names, sizeof(names)));
  EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-start %s: there is no such start for the %s; choose one of %s", name,
          problem->place, names);
}

PetscErrorCode EqmStartFind(const EqmProblem *problem, const char *name)
{
  const StartRow *row;

  PetscFunctionBegin;
  PetscCall(FindRow(problem, name, &row));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmStartNames(EqmStartFamily family, char *text, size_t length)
{
  PetscFunctionBegin;
  text[0] = '\0';
  for (int k = 0; k < NUM_STARTS; k++) {
    if (starts[k].family != family) continue;
    PetscCall(PetscStrlcat(text, text[0] ? ", " : "", length));
    PetscCall(PetscStrlcat(text, starts[k].name, length));
  }
  PetscFunctionReturn(0);
}

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

PetscErrorCode EqmStepToFold(EqmSolver solver, const PetscReal *velocity, PetscReal *step)
{
  const EqmMesh mesh = solver->mesh;
  PetscReal *first, *second, *a, local = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_local_cells, &first, mesh->num_local_cells, &second, mesh->num_local_cells, &a));
  PetscCall(EqmImageMeasure(solver->domain, &solver->place, a));
  PetscCall(EqmImageDerivatives(solver->domain, &solver->place, velocity, NULL, first, second));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    if (a[c] > 0.) local = PetscMin(local, FirstZero(a[c], first[c], .5 * second[c]));
  }
  PetscCall(MPIU_Allreduce(&local, step, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  *step = *step > 1.1 ? 1. : .5 * *step;
  PetscCall(PetscFree3(first, second, a));
  PetscFunctionReturn(0);
}

/* Towards the harmonic map of L_S(f) with the boundary held, but not through a fold (docs/methods.md, Starts). */
static PetscErrorCode FixedPointStep(EqmSolver solver, PetscBool guarded, PetscReal *weights, EqmPlace *to)
{
  const PetscInt n = solver->domain->dim * solver->mesh->num_local;
  PetscReal step = 1.;

  PetscFunctionBegin;
  PetscCall(EqmLaplacianWeights(solver->domain, EQM_LAPLACIAN_STRETCH, &solver->place, weights));
  PetscCall(EqmHarmonicMap(solver, weights, &solver->place, to));
  if (guarded) {
    for (PetscInt k = 0; k < n; k++) to->x[k] -= solver->place.x[k];
    PetscCall(EqmStepToFold(solver, to->x, &step));
    for (PetscInt k = 0; k < n; k++) to->x[k] = solver->place.x[k] + step * to->x[k];
  }
  PetscCall(EqmPlaceCopy(solver->domain, to, &solver->place));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartBoundary(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  (void)row;
  (void)steps;
  PetscFunctionBegin;
  PetscCall(EqmDomainPlaceBoundary(solver->domain, &solver->place));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartInPlane(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscReal *weights;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(solver->domain, &to));
  PetscCall(EqmDomainPlaceBoundary(solver->domain, &solver->place));
  PetscCall(EqmLaplacianWeights(solver->domain, row->laplacian, &solver->place, weights));
  PetscCall(EqmHarmonicMap(solver, weights, &solver->place, &to));
  PetscCall(EqmPlaceCopy(solver->domain, &to, &solver->place));
  for (PetscInt k = 0; k < steps; k++) PetscCall(FixedPointStep(solver, row->guarded, weights, &to));
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartOnSphere(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local_cells, &weights));
  PetscCall(EqmSphereLinear(solver, PETSC_FALSE));
  for (PetscInt k = 0; k < steps; k++) PetscCall(EqmSphereFixedPointStep(solver, k, weights));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartGuarded(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  (void)row;
  PetscFunctionBegin;
  PetscCall(EqmSphereGuarded(solver, steps));
  PetscFunctionReturn(0);
}

/* Fixed-point steps until the energy rises; the map before the rise, unfolded. */
static PetscErrorCode StartDescending(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscReal *weights, before;
  EqmPlace last;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local_cells, &weights));
  PetscCall(EqmPlaceCreate(solver->domain, &last));
  PetscCall(EqmSphereLinear(solver, PETSC_FALSE));
  PetscCall(EqmSolverLook(solver));
  for (PetscInt k = 0; k < steps; k++) {
    before = solver->totals.energy;
    PetscCall(EqmPlaceCopy(solver->domain, &solver->place, &last));
    PetscCall(EqmSphereFixedPointStep(solver, k, weights));
    PetscCall(EqmSolverLook(solver));
    if (solver->totals.energy < before) continue;
    PetscCall(EqmPlaceCopy(solver->domain, &last, &solver->place));
    break;
  }
  PetscCall(EqmSphereUnfold(solver, &solver->unfolded_from, &solver->unfolded_to));
  PetscCall(EqmPlaceDestroy(&last));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

/* The steps are those of the smoothing. */
static PetscErrorCode StartGauss(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscFunctionBegin;
  PetscCall(EqmSphereGauss(solver, steps));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartTutteOnSphere(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscReal *weights;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * solver->mesh->num_local_cells, &weights));
  PetscCall(EqmSphereTutte(solver));
  for (PetscInt k = 0; k < steps; k++) PetscCall(EqmSphereFixedPointStep(solver, k, weights));
  PetscCall(EqmSphereUnfold(solver, &solver->unfolded_from, &solver->unfolded_to));
  PetscCall(PetscFree(weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartResolved(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  (void)row;
  (void)steps;
  PetscFunctionBegin;
  PetscCall(EqmSphereResolved(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartConformal(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscFunctionBegin;
  PetscCall(EqmSphereLinear(solver, solver->problem->objective->fixed_metric));
  PetscCall(EqmMoebiusCenter(solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode StartInBall(EqmSolver solver, const StartRow *row, PetscInt steps)
{
  PetscFunctionBegin;
  PetscCall(EqmBallStart(solver, steps));
  PetscFunctionReturn(0);
}

/* Compute the first map that the settings ask for. Collective. */
PetscErrorCode EqmStart(EqmSolver solver)
{
  const StartRow *row;

  PetscFunctionBegin;
  PetscCall(FindRow(solver->problem, solver->settings.start, &row));
  PetscCall(row->run(solver, row, solver->settings.start_steps >= 0 ? solver->settings.start_steps : row->steps));
  PetscCall(EqmPlaceMakeFrames(solver->domain, &solver->place));
  if (solver->settings.center_start) PetscCall(EqmMoebiusCenter(solver));
  PetscFunctionReturn(0);
}
