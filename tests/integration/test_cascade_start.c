/* Runs that begin with -start cascade: they converge as those from the default start do, and turn angles less. */
#include "support/testing.h"

typedef struct {
  PetscReal start, energy, angle; /* mean error in degrees */
  EqmStatus status;
} Outcome;

static PetscErrorCode Run(const char *shape, PetscInt n, const char *target, const char *options, Outcome *outcome)
{
  const EqmDistortion *distortion;
  TestMesh test;
  EqmSolver solver;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test));
  PetscCall(TestSolve(test.mesh, target, options, &solver));
  PetscCall(EqmSolverGetMap(solver, test.soup, &map));
  PetscCall(EqmMapGetDistortion(map, &distortion));
  PetscCall(EqmMapGetEnergies(map, &outcome->start, &outcome->energy));
  CHECK(distortion->folds == 0, "%s, %s: %d folds", shape, options, (int)distortion->folds);
  outcome->angle = distortion->angle_error.mean;
  PetscCall(EqmSolverGetStatus(solver, &outcome->status, NULL));
  PetscCall(EqmMapDestroy(&map));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* About as far down as from the guarded start, from lower, and at the end the angles are off by `gain` degrees less. */
static PetscErrorCode TestTarget(const char *shape, PetscInt n, const char *target, const char *more, PetscReal gain)
{
  Outcome cascade, guarded;
  char options[2][128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options[0], sizeof(options[0]), "-start cascade -max_it 12 %s", more));
  PetscCall(PetscSNPrintf(options[1], sizeof(options[1]), "-start guarded -max_it 12 %s", more));
  PetscCall(Run(shape, n, target, options[0], &cascade));
  PetscCall(Run(shape, n, target, options[1], &guarded));
  CHECK(cascade.start < guarded.start, "%s, %s: starts at %g, not below %g", shape, target, (double)cascade.start,
        (double)guarded.start);
  CHECK(cascade.energy < 10. * guarded.energy, "%s, %s: energy %g, not %g", shape, target, (double)cascade.energy,
        (double)guarded.energy);
  CHECK(cascade.angle < guarded.angle - gain, "%s, %s: angles are off by %g degrees, not %g", shape, target,
        (double)cascade.angle, (double)guarded.angle);
  PetscFunctionReturn(0);
}

/* -method cascade: converges by itself, to a map whose energy is a few times lower than the start's and below `most`.
 */
static PetscErrorCode TestMethod(const char *shape, const char *target, PetscReal most)
{
  Outcome cascade;

  PetscFunctionBegin;
  PetscCall(Run(shape, 4000, target, "-method cascade", &cascade));
  CHECK(cascade.status == EQM_STATUS_CONVERGED, "%s, %s: -method cascade has not converged", shape, target);
  CHECK(cascade.energy < .5 * cascade.start && cascade.energy < most, "%s, %s: energy %g from %g", shape, target,
        (double)cascade.energy, (double)cascade.start);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestTarget("hills", 2000, "disk", "", 3.));
  PetscCall(TestTarget("hills", 2000, "square", "-corners 0,44,1899,1950", 3.)); /* the quarters of the boundary */
  PetscCall(TestTarget("head", 2000, "sphere", "", -.5));
  PetscCall(TestMethod("hills", "disk", 1e-3));
  PetscCall(TestMethod("hills", "square", 1e-3));
  PetscCall(TestMethod("head", "sphere", 1e-3));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
