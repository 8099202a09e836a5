/* The Riemann map: gradient by the boundary's angles, the loop's metric, maps that are known. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "method/loopgaps.h"
#include "method/loopmetric.h"
#include "method/riemann.h"
#include "store/map_private.h"

/* Angles at random, the same on any number of ranks. */
static PetscErrorCode RandomAngles(EqmSolver solver, EqmRiemann riemann, PetscInt seed, Vec angles)
{
  PetscScalar *a;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(angles, &a));
  for (PetscInt b = 0; b < riemann->num_boundary; b++)
    a[b] = TestRandom(seed, solver->mesh->vertex_input[riemann->boundary[b]], 0);
  PetscCall(VecRestoreArrayWrite(angles, &a));
  PetscFunctionReturn(0);
}

/* The slope of the energy along a direction, by central differences. */
static PetscErrorCode TestGradient(void)
{
  const PetscReal h = 1e-4;
  TestMesh test;
  EqmSolver solver;
  EqmRiemann riemann;
  EqmPlace place;
  Vec direction, gradient;
  PetscReal energy, ahead, behind, slope;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 400, 3, &test));
  PetscCall(TestStart(test.mesh, "disk", &solver));
  PetscCall(EqmRiemannCreate(solver->problem, &riemann));
  PetscCall(EqmRiemannCreateVec(solver->problem, riemann, &direction));
  PetscCall(VecDuplicate(direction, &gradient));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &place));
  PetscCall(RandomAngles(solver, riemann, 1, direction));
  PetscCall(EqmRiemannMove(solver->problem, riemann, &solver->iterate->place, .01, direction, &solver->iterate->place));
  PetscCall(RandomAngles(solver, riemann, 2, direction));
  PetscCall(EqmRiemannEnergy(solver->problem, riemann, &solver->iterate->place, &energy, gradient));
  PetscCall(VecDot(gradient, direction, &slope));
  PetscCall(EqmRiemannMove(solver->problem, riemann, &solver->iterate->place, h, direction, &place));
  PetscCall(EqmRiemannEnergy(solver->problem, riemann, &place, &ahead, gradient));
  PetscCall(EqmRiemannMove(solver->problem, riemann, &solver->iterate->place, -h, direction, &place));
  PetscCall(EqmRiemannEnergy(solver->problem, riemann, &place, &behind, gradient));
  CHECK_CLOSE((ahead - behind) / (2. * h), slope, 1e-6, PetscAbsReal(slope));
  CHECK(energy > .01, "energy %g", (double)energy);
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(VecDestroy(&direction));
  PetscCall(VecDestroy(&gradient));
  PetscCall(EqmRiemannDestroy(&riemann));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Centring leaves the mass centre of the harmonic map at zero, and the boundary in its order. */
static PetscErrorCode TestCentre(void)
{
  TestMesh test;
  EqmSolver solver;
  EqmRiemann riemann;
  Vec gradient;
  PetscReal energy, centre[2] = {0., 0.};
  PetscBool in_order;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 400, 3, &test));
  PetscCall(TestStart(test.mesh, "disk", &solver));
  PetscCall(EqmRiemannCreate(solver->problem, &riemann));
  PetscCall(EqmRiemannCentre(solver->problem, riemann, &solver->iterate->place));
  PetscCall(EqmRiemannCreateVec(solver->problem, riemann, &gradient));
  PetscCall(EqmRiemannEnergy(solver->problem, riemann, &solver->iterate->place, &energy, gradient));
  for (PetscInt c = 0; c < test.mesh->num_owned_cells; c++) {
    for (PetscInt k = 0; k < 6; k++)
      centre[k % 2] +=
          test.mesh->weight[c] / 3. * solver->iterate->place.x[2 * test.mesh->cells[3 * c + k / 2] + k % 2];
  }
  for (PetscInt k = 0; k < 2; k++) CHECK_CLOSE(TestSum(PETSC_COMM_WORLD, centre[k]), 0., 1e-11, 1.);
  PetscCall(EqmDomainBoundaryInOrder(solver->problem->domain, &solver->iterate->place, &in_order));
  CHECK(in_order, "centring spoilt the boundary's order");
  PetscCall(VecDestroy(&gradient));
  PetscCall(EqmRiemannDestroy(&riemann));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* On vertices with equal gaps the metric's eigenvectors are cos k theta, the eigenvalues those of linear elements. */
static PetscErrorCode TestLoopMetric(void)
{
  TestMesh test;
  EqmDomain domain;
  EqmLoop loop;
  EqmLoopMetric metric;
  PetscInt num = 0, *vertex, *place;
  PetscReal *x, *arc, *g, *h;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 1500, 0, &test));
  PetscCall(EqmDomainCreateDisk(test.mesh, &domain));
  const PetscInt n = test.mesh->num_local;
  PetscCall(PetscMalloc6(n, &vertex, n, &place, 2 * n, &x, n, &arc, n, &g, n, &h));
  PetscCall(EqmMeshBoundaryLoop(test.mesh, place, arc));
  const PetscReal gap = 2. * PETSC_PI / test.mesh->num_boundary_vertices;
  for (PetscInt v = 0; v < n; v++) {
    if (v < test.mesh->num_owned && test.mesh->on_boundary[v]) vertex[num++] = v;
    x[2 * v] = PetscCosReal(gap * place[v]);
    x[2 * v + 1] = PetscSinReal(gap * place[v]);
  }
  PetscCall(EqmLoopCreate(test.mesh, num, vertex, &loop));
  PetscCall(EqmLoopMetricCreate(loop, x, &metric));
  for (PetscInt k = 0; k < test.mesh->num_boundary_vertices / 2; k = 2 * k + 1) {
    const PetscReal eigenvalue = 2. * (1. - PetscCosReal(k * gap)) / PetscSqr(gap) + .5;
    for (PetscInt b = 0; b < num; b++) g[b] = PetscCosReal(k * gap * place[vertex[b]]);
    PetscCall(EqmLoopMetricApply(metric, g, h));
    for (PetscInt b = 0; b < num; b++) CHECK_CLOSE(h[b] * gap * PetscSqrtReal(eigenvalue), g[b], 2e-2, 1.);
  }
  PetscCall(EqmLoopMetricDestroy(&metric));
  PetscCall(EqmLoopDestroy(&loop));
  PetscCall(PetscFree6(vertex, place, x, arc, g, h));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* Vertices 0 to SQUEEZED of the loop at gaps close to their bounds: a projected direction opens or keeps these, keeps
   their mean, and is that of before elsewhere; a clipped one may be followed nearly to its end. */
static PetscErrorCode TestGaps(void)
{
  enum { SQUEEZED = 10 };
  TestMesh test;
  EqmDomain domain;
  EqmLoop loop;
  EqmGaps gaps;
  Vec direction;
  PetscScalar *d;
  PetscInt num = 0, *vertex, *place;
  PetscReal *x, *arc, *whole, *before, t, sum = 0., rest = 0.;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 1500, 0, &test));
  PetscCall(EqmDomainCreateDisk(test.mesh, &domain));
  const PetscInt n = test.mesh->num_local, m = test.mesh->num_boundary_vertices;
  const PetscReal gap = 2. * PETSC_PI / m;
  PetscCall(PetscMalloc6(n, &vertex, n, &place, 2 * n, &x, n, &arc, m, &whole, m, &before));
  PetscCall(EqmMeshBoundaryLoop(test.mesh, place, arc));
  for (PetscInt v = 0; v < n; v++) {
    if (v < test.mesh->num_owned && test.mesh->on_boundary[v]) vertex[num++] = v;
    x[2 * v] = PetscCosReal(gap * place[v]);
    x[2 * v + 1] = PetscSinReal(gap * place[v]);
  }
  PetscCall(EqmLoopCreate(test.mesh, num, vertex, &loop));
  PetscCall(EqmGapsCreate(loop, x, 1e-9, &gaps));
  for (PetscInt v = 0; v < n; v++) {
    const PetscReal angle = gap * (place[v] > SQUEEZED ? (PetscReal)place[v] : .015 * place[v]);
    x[2 * v] = PetscCosReal(angle);
    x[2 * v + 1] = PetscSinReal(angle);
  }
  PetscCall(EqmGapsSet(gaps, x));
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, num, m, &direction));
  PetscCall(VecGetArray(direction, &d));
  for (PetscInt b = 0; b < num; b++) d[b] = .3 * gap * TestRandom(5, place[vertex[b]], 0);
  PetscCall(EqmLoopGather(loop, d, before));
  PetscCall(VecRestoreArray(direction, &d));
  PetscCall(EqmGapsProject(gaps, direction));
  PetscCall(VecGetArray(direction, &d));
  PetscCall(EqmLoopGather(loop, d, whole));
  PetscCall(VecRestoreArray(direction, &d));
  for (PetscInt k = 0; k < loop->count; k++) {
    if (k < SQUEEZED) CHECK(whole[k + 1] >= whole[k], "gap %d closes", (int)k);
    if (k <= SQUEEZED)
      sum += whole[k] - before[k];
    else
      rest = PetscMax(rest, PetscAbsReal(whole[k] - before[k]));
  }
  CHECK(PetscAbsReal(sum) < 1e-15 && rest == 0., "mean off by %g, others by %g", (double)sum, (double)rest);
  PetscCall(EqmGapsClip(gaps, direction));
  PetscCall(EqmGapsLongestStep(gaps, direction, &t));
  CHECK(t > .05, "a clipped direction may be followed to %g only", (double)t);
  PetscCall(VecDestroy(&direction));
  PetscCall(EqmGapsDestroy(&gaps));
  PetscCall(EqmLoopDestroy(&loop));
  PetscCall(PetscFree6(vertex, place, x, arc, whole, before));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* How far the map of a cap is from the stereographic projection, or that of a flat one from itself. */
static PetscErrorCode CapError(PetscInt n, PetscBool flat, PetscReal *error, EqmDistortion *distortion)
{
  TestMesh test;
  EqmSolver solver;
  EqmMap map;
  PetscReal *exact, radius = 0.;

  PetscFunctionBegin;
  PetscCall(TestCapCreate(n, flat, &test));
  /* Below about 4e-8 the objective, near 3, changes by its rounding only: whether a step is still found is chance. */
  PetscCall(TestSolve(test.mesh, "conformal", "-energy_rtol 0 -gradient_tol 1e-6", &solver));
  PetscCall(PetscMalloc1(2 * test.mesh->num_local, &exact));
  for (PetscInt v = 0; v < test.mesh->num_local; v++) {
    const PetscReal *const p = test.mesh->position + 3 * v;
    for (PetscInt k = 0; k < 2; k++) exact[2 * v + k] = p[k] / (1. + p[2]);
    radius = PetscMax(radius, PetscSqrtReal(PetscSqr(exact[2 * v]) + PetscSqr(exact[2 * v + 1])));
  }
  radius = TestMax(PETSC_COMM_WORLD, radius);
  for (PetscInt k = 0; k < 2 * test.mesh->num_local; k++) exact[k] /= radius;
  *error = TestRmsAfterRotation(test.mesh, solver->iterate->place.x, exact);
  PetscCall(EqmSolverGetMap(solver, test.soup, &map));
  *distortion = map->distortion;
  CHECK(map->status == EQM_STATUS_CONVERGED, "%s", map->message);
  CHECK(map->cost.work.factorizations == 1, "%d factorisations", (int)map->cost.work.factorizations);
  PetscCall(EqmMapDestroy(&map));
  PetscCall(PetscFree(exact));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestKnownMaps(void)
{
  EqmDistortion coarse, fine, flat;
  PetscReal coarse_error, fine_error, flat_error;

  PetscFunctionBegin;
  PetscCall(CapError(700, PETSC_TRUE, &flat_error, &flat));
  /* but for the Moebius map that brings the mesh's mass centre, not quite at the pole, to the disk's */
  CHECK(flat_error < 1e-4, "a flat disk moved by %g", (double)flat_error);
  CHECK(flat.angle_error.max < 1e-3 && flat.folds == 0, "angles of a flat disk changed by up to %g degrees",
        (double)flat.angle_error.max);
  PetscCall(CapError(700, PETSC_FALSE, &coarse_error, &coarse));
  PetscCall(CapError(2800, PETSC_FALSE, &fine_error, &fine));
  CHECK(coarse_error < 5e-3 && coarse.folds == 0, "a cap is off by %g", (double)coarse_error);
  CHECK(fine_error < coarse_error / 3., "errors %g and %g with half the mesh width: not of second order",
        (double)coarse_error, (double)fine_error);
  CHECK(fine.angle_error.mean < coarse.angle_error.mean / 1.6, "angle errors %g and %g degrees",
        (double)coarse.angle_error.mean, (double)fine.angle_error.mean);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestGradient());
  PetscCall(TestCentre());
  PetscCall(TestLoopMetric());
  PetscCall(TestGaps());
  PetscCall(TestKnownMaps());
  PetscCall(EqmFinalize());
  return 0;
}
