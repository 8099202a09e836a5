/* Whole runs of angle-preserving maps of closed surfaces: small angle errors without folds, the sphere itself, the same
   map on any number of ranks, the same bits for any number of threads. */
#include "support/runs.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "store/map_private.h"

/* Converged, no folds, small angle errors, few factorisations. */
static PetscErrorCode TestMethod(const char *shape, PetscInt n, const char *options, PetscReal degrees)
{
  TestMesh test;
  EqmMap map;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test));
  PetscCall(TestMap(&test, "conformal", options, &map));
  CHECK(map->status == EQM_STATUS_CONVERGED && map->distortion.folds == 0, "%s %s: status %d, %d folds: %s", shape,
        options, (int)map->status, (int)map->distortion.folds, map->message);
  CHECK(map->distortion.angle_error.mean < degrees, "%s %s: angle error %g degrees", shape, options,
        (double)map->distortion.angle_error.mean);
  CHECK(map->energy_final >= map->distortion.image_measure && map->energy_final < 4. * PETSC_PI * 1.02,
        "%s %s: Dirichlet energy %g", shape, options, (double)map->energy_final);
  PetscCall(EqmMapDestroy(&map));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Mutual distances do not know rotations. */
static PetscReal Distance(const PetscReal *p, const PetscReal *q)
{
  const PetscReal d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  return PetscSqrtReal(EqmDot3(d, d));
}

/* The sphere's conformal map with its mass centre in the middle is the sphere's own, so centred, up to the error of the
   mesh. */
static PetscErrorCode TestSphereItself(void)
{
  TestMesh test;
  EqmSolver solver;
  EqmPlace itself;
  const PetscReal *mass;
  PetscReal offset, center[3], farthest = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "sphere", 1000, 1, &test));
  PetscCall(TestSolve(test.mesh, "conformal", "", &solver));
  PetscCall(EqmProblemGetVertexMass(solver->problem, &mass));
  PetscCall(EqmPlaceMassCenter(solver->problem->domain, mass, &solver->iterate->place, center));
  CHECK_CLOSE(PetscSqrtReal(EqmDot3(center, center)), 0., 1e-12, 1.);
  PetscCall(EqmPlaceCreate(solver->problem->domain, &itself));
  PetscCall(PetscArraycpy(itself.x, test.mesh->position, 3 * test.mesh->num_local));
  PetscCall(EqmPlaceCenter(solver->problem->domain, mass, &itself, &offset));
  for (PetscInt k = 1; k < test.mesh->num_local; k++) {
    const PetscReal *const x = solver->iterate->place.x, *const y = itself.x;
    farthest = PetscMax(farthest, PetscAbsReal(Distance(x, x + 3 * k) - Distance(y, y + 3 * k)));
  }
  CHECK(farthest < 1e-4, "distances differ by %g", (double)farthest);
  CHECK_CLOSE(solver->iterate->totals.energy, solver->iterate->totals.total, 1e-6, 1.);
  PetscCall(EqmPlaceDestroy(&itself));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* All methods go to the same map: the harmonic one differs from that of least conformal energy by the mesh's error. */
static PetscErrorCode TestSameMap(const char *options, PetscReal tolerance)
{
  TestMesh test;
  EqmSolver solver[2];
  PetscReal farthest = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 200, 1, &test));
  PetscCall(TestSolve(test.mesh, "conformal", "", &solver[0]));
  PetscCall(TestSolve(test.mesh, "conformal", options, &solver[1]));
  CHECK(solver[1]->status == EQM_STATUS_CONVERGED, "%s: status %d: %s", options, (int)solver[1]->status,
        solver[1]->message);
  for (PetscInt k = 1; k < test.mesh->num_local; k++) {
    const PetscReal *const x = solver[0]->iterate->place.x, *const y = solver[1]->iterate->place.x;
    farthest = PetscMax(farthest, PetscAbsReal(Distance(x, x + 3 * k) - Distance(y, y + 3 * k)));
  }
  CHECK(farthest < tolerance, "%s: distances differ by %g", options, (double)farthest);
  PetscCall(EqmSolverDestroy(&solver[0]));
  PetscCall(EqmSolverDestroy(&solver[1]));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Beyond its limit the explicit method ends without success. */
static PetscErrorCode TestExplicitLimit(const char *options, PetscBool stable)
{
  TestMesh test;
  EqmSolver solver;
  PetscBool rises;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 200, 1, &test));
  PetscCall(TestSolve(test.mesh, "conformal", options, &solver));
  rises = (PetscBool)(strstr(solver->message, "too long") != NULL);
  CHECK(rises == !stable && solver->status == EQM_STATUS_NOT_CONVERGED, "%s: %s", options, solver->message);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestMethod("head", 1000, "", 1.));
  PetscCall(TestMethod("head", 1000, "-start tutte", 1.));
  PetscCall(TestMethod("head", 1000, "-start gauss -start_center", 1.));
  PetscCall(TestMethod("head", 1000, "-method qiem -start gauss -qiem_phase1 none -qiem_phase2 a -flow_tol 1e-6", 1.));
  PetscCall(TestSphereItself());
  PetscCall(TestSameMap("-method qiem -flow_tol 1e-7", .02));
  PetscCall(TestSameMap("-method qiem -flow_moebius -flow_step 20 -qiem_phase2 a -flow_tol 1e-7", .02));
  PetscCall(TestSameMap("-method qiem -start tutte -qiem_phase1 none -flow_step 5 -flow_tol 1e-7", .02));
  PetscCall(TestSameMap("-method euler-implicit -flow_tol 1e-7", .02));
  PetscCall(TestSameMap("-method euler-explicit -flow_tol 1e-6", .02));
  PetscCall(TestExplicitLimit("-method euler-explicit -max_it 100 -flow_tol 0", PETSC_TRUE));
  PetscCall(TestExplicitLimit("-method euler-explicit -max_it 100 -flow_tol 0 -flow_step 2", PETSC_FALSE));
  PetscCall(TestSameOnRanks("head", 500, "conformal", "", 1e-7, 1.));
  PetscCall(TestSameOnRanks("head", 500, "conformal", "-method qiem -max_it 5", 1e-7, 1.));
  PetscCall(TestSameOnRanks("head", 500, "conformal", "-method euler-implicit -max_it 2", 1e-7, 1.));
  PetscCall(TestSameOnRanks("head", 500, "conformal", "-method euler-explicit -max_it 5", 1e-7, 1.));
  PetscCall(TestSameWithThreads(PETSC_COMM_SELF, "head", 900, "conformal", ""));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
