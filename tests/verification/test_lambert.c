/* A spherical cap has an exact area-preserving map to the disk, Lambert's: radius sin(polar / 2) / sin(opening / 2). */
#include "support/testing.h"
#include "mesh/mesh_private.h"

static const PetscReal opening = 2.; /* polar angle of the generated cap's rim */

static PetscReal PolarAngle(const PetscReal *p)
{
  return PetscAtan2Real(PetscSqrtReal(p[0] * p[0] + p[1] * p[1]), p[2]);
}

static PetscReal LambertRadius(PetscReal polar)
{
  return PetscSinReal(.5 * polar) / PetscSinReal(.5 * opening);
}

/* Every vertex at the place that a radial map gives it. */
static void PlaceLambert(EqmMesh mesh, EqmPlace *place)
{
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const p = mesh->position + 3 * v;
    const PetscReal radius = LambertRadius(PolarAngle(p)), azimuth = PetscAtan2Real(p[1], p[0]);
    place->x[2 * v] = radius * PetscCosReal(azimuth);
    place->x[2 * v + 1] = radius * PetscSinReal(azimuth);
  }
}

/* The energy of Lambert's map at the vertices is that of the discretisation alone: it falls as h^2, by 4 where there
   are four times as many vertices. */
static PetscErrorCode TestEnergyConverges(void)
{
  PetscReal energy[4], *a;
  PetscInt size[4];
  TestMesh test;
  EqmDomain domain;
  EqmPlace place;

  PetscFunctionBegin;
  for (int k = 0; k < 4; k++) {
    PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 250 << 2 * k, 1, &test));
    PetscCall(EqmDomainCreateDisk(test.mesh, &domain));
    PetscCall(EqmPlaceCreate(domain, &place));
    PetscCall(PetscMalloc1(test.mesh->num_local_cells, &a));
    PlaceLambert(test.mesh, &place);
    PetscCall(EqmAuthalicEnergy(domain, &place, a, &energy[k], NULL));
    size[k] = test.mesh->num_vertices;
    PetscCall(PetscFree(a));
    PetscCall(EqmPlaceDestroy(&place));
    PetscCall(EqmDomainDestroy(&domain));
    PetscCall(TestMeshDestroy(&test));
    if (k == 0) continue;
    const PetscReal order =
        2. * PetscLogReal(energy[k - 1] / energy[k]) / PetscLogReal((PetscReal)size[k] / size[k - 1]);
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "Lambert, %d vertices: energy %.3e, order %.2f in h\n", (int)size[k],
                          (double)energy[k], (double)order));
    CHECK(order > 1.8, "the energy falls as h^%g only", (double)order);
  }
  CHECK(energy[3] < 1e-3, "%g", (double)energy[3]);
  PetscFunctionReturn(0);
}

/* The solver gets below the interpolated exact map: zero is within reach of the discrete problem. */
static PetscErrorCode TestSolverBeatsInterpolation(void)
{
  PetscReal exact, *a;
  TestMesh test;
  EqmSolver solver;
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 1000, 1, &test));
  PetscCall(TestSolve(test.mesh, "disk", "-method lm", &solver));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &place));
  PetscCall(PetscMalloc1(test.mesh->num_local_cells, &a));
  PlaceLambert(test.mesh, &place);
  PetscCall(EqmAuthalicEnergy(solver->problem->domain, &place, a, &exact, NULL));
  CHECK(solver->iterate->totals.folds == 0 && solver->iterate->totals.energy < .1 * exact, "%g, Lambert %g",
        (double)solver->iterate->totals.energy, (double)exact);
  PetscCall(PetscFree(a));
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* ---- the balanced minimiser: area-preserving maps are many, but with a share of angle energy there is one, and on a
   cap it is radial. Its profile minimises a one-dimensional function, found here by Newton's method on a fine grid. */

enum { NUM_RINGS = 400 };

/* Value, gradient and Hessian (tridiagonal: diagonal and what couples k to k + 1) of the balanced energy of radii R_k
   at polar angles k opening / NUM_RINGS; R_0 = 0 and R_NUM_RINGS = 1. */
static void RadialEnergy(PetscReal epsilon, const PetscReal *radius, PetscReal *gradient, PetscReal *diagonal,
                         PetscReal *coupling)
{
  const PetscReal h = opening / NUM_RINGS, total = 1. - PetscCosReal(opening);

  for (PetscInt k = 0; k <= NUM_RINGS; k++) gradient[k] = diagonal[k] = coupling[k] = 0.;
  for (PetscInt k = 0; k < NUM_RINGS; k++) {
    const PetscReal inner = radius[k], outer = radius[k + 1], middle = PetscSinReal((k + .5) * h);
    const PetscReal w = (PetscCosReal(k * h) - PetscCosReal((k + 1) * h)) / total;
    const PetscReal r = (outer * outer - inner * inner) / w, l = PetscLogReal(r);
    /* w rho^2 and its first two derivatives by r */
    const PetscReal first = w * (r > 1. ? 2. * (r - 1.) : 2. * l / r),
                    second = w * (r > 1. ? 2. : 2. * (1. - l) / (r * r));
    const PetscReal dr[2] = {-2. * inner / w, 2. * outer / w}, ddr[2] = {-2. / w, 2. / w};
    /* (epsilon / pi) E_D of the ring: epsilon (R'^2 sin + R^2 / sin) h, R at the ring's middle */
    const PetscReal along = 2. * epsilon * middle / h, round = epsilon * h / middle, mean = .5 * (inner + outer);
    gradient[k] += first * dr[0] - along * (outer - inner) + round * mean;
    gradient[k + 1] += first * dr[1] + along * (outer - inner) + round * mean;
    diagonal[k] += second * dr[0] * dr[0] + first * ddr[0] + along + .5 * round;
    diagonal[k + 1] += second * dr[1] * dr[1] + first * ddr[1] + along + .5 * round;
    coupling[k] += second * dr[0] * dr[1] - along + .5 * round;
  }
}

/* Solve the tridiagonal system for the inner radii; the solution is in `gradient`. */
static void SolveTridiagonal(PetscReal *diagonal, const PetscReal *coupling, PetscReal *gradient)
{
  for (PetscInt k = 2; k < NUM_RINGS; k++) {
    const PetscReal factor = coupling[k - 1] / diagonal[k - 1];
    diagonal[k] -= factor * coupling[k - 1];
    gradient[k] -= factor * gradient[k - 1];
  }
  for (PetscInt k = NUM_RINGS - 1; k >= 1; k--)
    gradient[k] = (gradient[k] - (k + 1 < NUM_RINGS ? coupling[k] * gradient[k + 1] : 0.)) / diagonal[k];
}

/* From Lambert's profile, which is near. */
static void RadialMinimiser(PetscReal epsilon, PetscReal *radius)
{
  PetscReal step[NUM_RINGS + 1], diagonal[NUM_RINGS + 1], coupling[NUM_RINGS + 1], largest = 1.;

  for (PetscInt k = 0; k <= NUM_RINGS; k++) radius[k] = LambertRadius(k * opening / NUM_RINGS);
  for (PetscInt round = 0; round < 50 && largest > 1e-12; round++) {
    RadialEnergy(epsilon, radius, step, diagonal, coupling);
    SolveTridiagonal(diagonal, coupling, step);
    largest = 0.;
    for (PetscInt k = 1; k < NUM_RINGS; k++) {
      radius[k] -= step[k];
      largest = PetscMax(largest, PetscAbsReal(step[k]));
    }
  }
  CHECK(largest <= 1e-12, "Newton's method on the radial problem has not converged: %g", (double)largest);
}

static PetscReal Profile(const PetscReal *radius, PetscReal polar)
{
  const PetscReal at = PetscMin(polar / opening * NUM_RINGS, NUM_RINGS - 1e-9);
  const PetscInt k = (PetscInt)at;
  return radius[k] + (at - k) * (radius[k + 1] - radius[k]);
}

/* Rms distance from the radial map of that profile, after the best rotation. */
static PetscErrorCode DistanceFromRadial(EqmMesh mesh, const PetscReal *x, const PetscReal *radius, PetscReal *distance)
{
  PetscReal *y;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * mesh->num_local, &y));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal *const p = mesh->position + 3 * v;
    const PetscReal r = Profile(radius, PolarAngle(p)), azimuth = PetscAtan2Real(p[1], p[0]);
    y[2 * v] = r * PetscCosReal(azimuth);
    y[2 * v + 1] = r * PetscSinReal(azimuth);
  }
  *distance = TestRmsAfterRotation(mesh, y, x);
  PetscCall(PetscFree(y));
  PetscFunctionReturn(0);
}

/* The solver's balanced map converges to the radial minimiser, and that is not Lambert's map. */
static PetscErrorCode TestBalanced(PetscReal epsilon)
{
  PetscReal radius[NUM_RINGS + 1], lambert[NUM_RINGS + 1], distance[2], from_lambert, apart = 0.;
  char options[128];
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  RadialMinimiser(epsilon, radius);
  for (PetscInt k = 0; k <= NUM_RINGS; k++) {
    lambert[k] = LambertRadius(k * opening / NUM_RINGS);
    apart = PetscMax(apart, PetscAbsReal(lambert[k] - radius[k]));
  }
  PetscCall(
      PetscSNPrintf(options, sizeof(options), "-method lm -balance %g -max_it 60 -energy_rtol 1e-6", (double)epsilon));
  for (int k = 0; k < 2; k++) {
    PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 500 << 2 * k, 1, &test));
    PetscCall(TestSolve(test.mesh, "disk", options, &solver));
    PetscCall(DistanceFromRadial(test.mesh, solver->iterate->place.x, radius, &distance[k]));
    PetscCall(DistanceFromRadial(test.mesh, solver->iterate->place.x, lambert, &from_lambert));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                          "balance %g, %d vertices: %.2e from the radial minimiser, %.2e from Lambert's map (which is "
                          "up to %.2e from it)\n",
                          (double)epsilon, (int)test.mesh->num_vertices, (double)distance[k], (double)from_lambert,
                          (double)apart));
    CHECK(solver->iterate->totals.folds == 0, "%d folds", (int)solver->iterate->totals.folds);
    PetscCall(EqmSolverDestroy(&solver));
    PetscCall(TestMeshDestroy(&test));
  }
  CHECK(distance[1] < .3 * distance[0] && distance[1] < .2 * apart, "%g, then %g", (double)distance[0],
        (double)distance[1]);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestEnergyConverges());
  PetscCall(TestSolverBeatsInterpolation());
  PetscCall(TestBalanced(.1));
  PetscCall(TestBalanced(1.));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
