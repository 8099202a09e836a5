/* The conformal energy on the sphere against differences, its lower bound, and the step limit of its objective. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

typedef struct {
  TestMesh test;
  EqmSolver solver;
  EqmDomain domain;
  PetscReal *a;
  const PetscReal *weights, *mass;
} Setting;

static PetscErrorCode Begin(const char *shape, PetscInt n, const char *start, Setting *s)
{
  char text[128];

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 3, &s->test));
  PetscCall(PetscSNPrintf(text, sizeof(text), "-max_it 0 -start %s", start));
  PetscCall(TestSolve(s->test.mesh, "conformal", text, &s->solver));
  s->domain = s->solver->problem->domain;
  PetscCall(EqmProblemGetAngleWeights(s->solver->problem, &s->weights));
  PetscCall(EqmProblemGetVertexMass(s->solver->problem, &s->mass));
  PetscCall(PetscMalloc1(s->test.mesh->num_local_cells, &s->a));
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Setting *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->a));
  PetscCall(EqmSolverDestroy(&s->solver));
  PetscCall(TestMeshDestroy(&s->test));
  PetscFunctionReturn(0);
}

/* The slope along a geodesic by differences of fourth order, with and without the mass centre. */
static PetscErrorCode TestGradient(Setting *s, const PetscReal *mass)
{
  const PetscReal h = 1e-3;
  PetscReal value, at[4], product;
  EqmPlace to;
  Vec step, gradient;

  PetscFunctionBegin;
  PetscCall(EqmDomainCreateVec(s->domain, &step));
  PetscCall(VecDuplicate(step, &gradient));
  PetscCall(EqmPlaceCreate(s->domain, &to));
  PetscCall(TestRandomStep(s->domain, 4, .1, step));
  PetscCall(EqmConformalEnergy(s->domain, s->weights, mass, &s->solver->iterate->place, s->a, &value, gradient));
  PetscCall(VecDot(gradient, step, &product));
  for (int k = 0; k < 4; k++) {
    PetscCall(EqmDomainMove(s->domain, &s->solver->iterate->place, (k < 2 ? k - 2 : k - 1) * h, step, &to));
    PetscCall(EqmConformalEnergy(s->domain, s->weights, mass, &to, s->a, &at[k], NULL));
  }
  CHECK_CLOSE((8. * (at[2] - at[1]) - (at[3] - at[0])) / (12. * h), product, 1e-8, PetscAbsReal(product));
  CHECK(PetscAbsReal(product) > 1e-3, "a slope of %g shows nothing", (double)product);
  PetscCall(EqmPlaceDestroy(&to));
  PetscCall(VecDestroy(&step));
  PetscCall(VecDestroy(&gradient));
  PetscFunctionReturn(0);
}

/* E_D - A is never negative, what it says it is, and zero for the surface itself where that is the sphere. */
static PetscErrorCode TestValue(Setting *s, PetscBool itself)
{
  const EqmMesh mesh = s->test.mesh;
  PetscReal energy, dirichlet, center[3], with_center;
  EqmImageTotals totals;
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->domain, &place));
  PetscCall(EqmPlaceCopy(s->domain, &s->solver->iterate->place, &place));
  if (itself) PetscCall(PetscArraycpy(place.x, mesh->position, 3 * mesh->num_local));
  PetscCall(EqmConformalEnergy(s->domain, s->weights, NULL, &place, s->a, &energy, NULL));
  PetscCall(EqmConformalEnergy(s->domain, s->weights, s->mass, &place, s->a, &with_center, NULL));
  PetscCall(EqmImageSum(mesh, s->a, &totals));
  PetscCall(EqmLaplacianEnergy(mesh, s->weights, 3, place.x, &dirichlet));
  PetscCall(EqmPlaceMassCenter(s->domain, s->mass, &place, center));
  CHECK_CLOSE(energy, dirichlet - totals.total, 1e-13, dirichlet);
  CHECK_CLOSE(with_center, energy + .5 * EqmDot3(center, center), 1e-13, 1.);
  CHECK(energy > (itself ? -1e-13 : 1e-3), "E_D - A = %g", (double)energy);
  if (itself) CHECK_CLOSE(energy, 0., 1e-13, 1.);
  PetscCall(EqmPlaceDestroy(&place));
  PetscFunctionReturn(0);
}

/* Smallest determinant of the places moved straight on by t; negative if a cell folds. */
static PetscErrorCode SmallestDet(Setting *s, const PetscReal *velocity, PetscReal t, PetscReal *smallest)
{
  const EqmMesh mesh = s->test.mesh;
  PetscReal local = PETSC_MAX_REAL;
  EqmPlace to;

  PetscFunctionBegin;
  PetscCall(EqmPlaceCreate(s->domain, &to));
  for (PetscInt k = 0; k < 3 * mesh->num_local; k++) to.x[k] = s->solver->iterate->place.x[k] + t * velocity[k];
  PetscCall(EqmImageMeasureOf(s->domain, EQM_MEASURE_HALF_DET, &to, s->a));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) local = PetscMin(local, s->a[c]);
  *smallest = -TestMax(mesh->comm, -local);
  PetscCall(EqmPlaceDestroy(&to));
  PetscFunctionReturn(0);
}

/* The step limit stops at .8 of the first fold, for steps that are far too long, and lets short ones pass. */
static PetscErrorCode TestStepLimit(Setting *s, PetscReal size)
{
  PetscReal *velocity, t, smallest;
  Vec step;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * s->test.mesh->num_local, &velocity));
  PetscCall(EqmDomainCreateVec(s->domain, &step));
  PetscCall(TestRandomStep(s->domain, 9, size, step));
  PetscCall(EqmDomainExpand(s->domain, &s->solver->iterate->place, step, velocity));
  PetscCall(EqmObjectiveConformal.longest_step(s->solver->problem, s->solver->iterate, step, &t));
  CHECK(t > 0. && t <= 1., "t = %g", (double)t);
  PetscCall(SmallestDet(s, velocity, t, &smallest));
  CHECK(smallest > 0., "a cell folds before the limit %g", (double)t);
  PetscCall(SmallestDet(s, velocity, t / .8, &smallest));
  CHECK(smallest > -1e-12, "the limit %g is more than .8 of the first fold", (double)t);
  if (t < 1.) {
    PetscCall(SmallestDet(s, velocity, 1.01 * t / .8, &smallest));
    CHECK(smallest < 0., "no fold beyond the limit %g", (double)t);
  }
  CHECK((t < 1.) == (size > .01), "size %g: t = %g", (double)size, (double)t);
  PetscCall(VecDestroy(&step));
  PetscCall(PetscFree(velocity));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Setting s;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(Begin("head", 700, "tutte", &s));
  PetscCall(TestGradient(&s, NULL));
  PetscCall(TestGradient(&s, s.mass));
  PetscCall(TestValue(&s, PETSC_FALSE));
  PetscCall(TestStepLimit(&s, 1e-5));
  PetscCall(TestStepLimit(&s, .3));
  PetscCall(TestStepLimit(&s, 2.));
  PetscCall(End(&s));
  PetscCall(Begin("sphere", 700, "tutte", &s));
  PetscCall(TestValue(&s, PETSC_TRUE));
  PetscCall(End(&s));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
