/* Mobius maps as matrices, and the choices of one at the end of an angle-preserving map. */
#include "support/runs.h"
#include "mesh/mesh_private.h"
#include "domain/projective.h"
#include "geometry/simplex.h"
#include <unistd.h>

static PetscReal Distance(const PetscReal *p, const PetscReal *q)
{
  const PetscReal d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  return PetscSqrtReal(EqmDot3(d, d));
}

/* Points of the sphere at random, the poles among them. */
static void RandomPoints(PetscInt seed, PetscInt count, PetscReal *x)
{
  for (PetscInt i = 0; i < count; i++) {
    PetscReal length;
    for (PetscInt k = 0; k < 3; k++) x[3 * i + k] = i < 2 ? (k == 2) * (i ? -1. : 1.) : TestRandom(seed, i, k);
    length = PetscSqrtReal(EqmDot3(x + 3 * i, x + 3 * i));
    for (PetscInt k = 0; k < 3; k++) x[3 * i + k] /= length;
  }
}

/* The exponential follows its field, by differences; pulls alone are shifts; everything is undone by the opposite. */
static PetscErrorCode TestExponential(void)
{
  enum { N = 12 };
  const PetscReal turn[3] = {.3, -.2, .5}, pull[3] = {-.4, .6, .1}, zero[3] = {0., 0., 0.}, h = 1e-3;
  PetscReal x[3 * N];

  PetscFunctionBegin;
  RandomPoints(1, N, x);
  for (PetscInt i = 0; i < N; i++) {
    PetscReal at[4][3], back[3], field[3];
    const PetscReal *const p = x + 3 * i;
    for (int d = 0; d < 4; d++) {
      const PetscReal t = (d < 2 ? d - 2 : d - 1) * h, w[3] = {t * turn[0], t * turn[1], t * turn[2]},
                      b[3] = {t * pull[0], t * pull[1], t * pull[2]};
      const EqmMoebius map = EqmMoebiusExponential(w, b);
      EqmMoebiusApply(&map, p, at[d]);
    }
    EqmCross(turn, p, field);
    for (int k = 0; k < 3; k++) {
      field[k] += pull[k] - EqmDot3(pull, p) * p[k];
      CHECK_CLOSE((8. * (at[2][k] - at[1][k]) - (at[3][k] - at[0][k])) / (12. * h), field[k], 1e-10, 1.);
    }
    const PetscReal w[3] = {-turn[0], -turn[1], -turn[2]}, b[3] = {-pull[0], -pull[1], -pull[2]};
    const EqmMoebius there = EqmMoebiusExponential(turn, pull), home = EqmMoebiusExponential(w, b),
                     both = EqmMoebiusProduct(&home, &there), none = EqmMoebiusExponential(zero, zero);
    EqmMoebiusApply(&both, p, back);
    CHECK_CLOSE(Distance(back, p), 0., 1e-14, 1.);
    EqmMoebiusApply(&none, p, back);
    CHECK_CLOSE(Distance(back, p), 0., 1e-15, 1.);
  }
  PetscFunctionReturn(0);
}

/* Three points go where they should; a fourth keeps its cross ratio. */
static PetscErrorCode TestThrough(void)
{
  enum { N = 12 };
  PetscReal x[3 * N], q[3 * N], y[3], z[3];

  PetscFunctionBegin;
  RandomPoints(2, N, x);
  RandomPoints(3, N, q);
  for (PetscInt i = 0; i + 3 < N; i++) {
    const PetscReal *const p = x + 3 * i, *const r = q + 3 * i;
    const EqmMoebius map = EqmMoebiusThrough(p, r);
    for (PetscInt k = 0; k < 3; k++) {
      EqmMoebiusApply(&map, p + 3 * k, y);
      CHECK_CLOSE(Distance(y, r + 3 * k), 0., 1e-12, 1.);
    }
    EqmMoebiusApply(&map, p + 9, z);
    const PetscReal before =
        Distance(p, p + 3) * Distance(p + 6, p + 9) / (Distance(p, p + 6) * Distance(p + 3, p + 9));
    const PetscReal after = Distance(r, r + 3) * Distance(r + 6, z) / (Distance(r, r + 6) * Distance(r + 3, z));
    CHECK_CLOSE(after, before, 1e-10, before);
  }
  PetscFunctionReturn(0);
}

/* A known map is found again from exact landmarks; a rotation where only that is wanted or possible. */
static PetscErrorCode TestAlign(void)
{
  enum { N = 9 };
  const PetscReal turn[3] = {1.1, -.4, 2.}, pull[3] = {.5, .3, -.6}, zero[3] = {0., 0., 0.};
  PetscReal x[3 * N], q[3 * N], distance;
  EqmMoebius map = EqmMoebiusExponential(turn, pull);

  PetscFunctionBegin;
  RandomPoints(4, N, x);
  for (PetscInt i = 0; i < N; i++) EqmMoebiusApply(&map, x + 3 * i, q + 3 * i);
  PetscCall(EqmMoebiusAlign(N, x, q, PETSC_FALSE, &map, &distance));
  CHECK_CLOSE(distance, 0., 1e-10, 1.);
  PetscCall(EqmMoebiusAlign(N, x, q, PETSC_TRUE, &map, &distance));
  CHECK(distance > .05 && distance < 1., "a rotation leaves %g", (double)distance);
  map = EqmMoebiusExponential(turn, zero);
  for (PetscInt i = 0; i < N; i++) EqmMoebiusApply(&map, x + 3 * i, q + 3 * i);
  PetscCall(EqmMoebiusAlign(N, x, q, PETSC_TRUE, &map, &distance));
  CHECK_CLOSE(distance, 0., 1e-13, 1.);
  PetscCall(EqmMoebiusAlign(2, x, q, PETSC_FALSE, &map, &distance));
  CHECK_CLOSE(distance, 0., 1e-13, 1.);
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(TestMesh *test, const char *options, EqmSolver *solver)
{
  PetscFunctionBegin;
  PetscCall(TestSolve(test->mesh, "conformal", options, solver));
  PetscFunctionReturn(0);
}

/* Largest distance of the vertices with these input numbers from the points. */
static PetscReal Off(EqmSolver solver, PetscInt count, const PetscInt *vertex, const PetscReal *points)
{
  PetscReal most = 0.;

  for (PetscInt v = 0; v < solver->mesh->num_owned; v++) {
    for (PetscInt i = 0; i < count; i++) {
      if (solver->mesh->vertex_input[v] != vertex[i]) continue;
      most = PetscMax(most, Distance(solver->iterate->place.x + 3 * v, points + 3 * i));
    }
  }
  return TestMax(solver->comm, most);
}

static PetscErrorCode TestFix(TestMesh *test)
{
  const PetscInt vertex[3] = {17, 3, 200};
  const PetscReal third = PetscSqrtReal(.75), equator[9] = {1., 0., 0., -.5, third, 0., -.5, -third, 0.};
  const PetscReal given[9] = {0., 0., 1., 0., 1., 0., .6, 0., -.8};
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(Solve(test, "-fix 17,3,200", &solver));
  CHECK_CLOSE(Off(solver, 3, vertex, equator), 0., 1e-11, 1.);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(Solve(test, "-fix 17,3,200 -fix_points 0,0,2,0,1,0,.6,0,-.8", &solver));
  CHECK_CLOSE(Off(solver, 3, vertex, given), 0., 1e-11, 1.);
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* The area distortion is least: no small shift makes it less, and it is less than with the mass centre in the middle.
 */
static PetscErrorCode TestArea(TestMesh *test)
{
  EqmSolver centred, solver;
  PetscReal *image, before, least, energy;
  EqmPlace place;

  PetscFunctionBegin;
  PetscCall(Solve(test, "", &centred));
  PetscCall(Solve(test, "-moebius area", &solver));
  PetscCall(PetscMalloc1(test->mesh->num_local_cells, &image));
  PetscCall(EqmPlaceCreate(solver->problem->domain, &place));
  PetscCall(EqmAuthalicEnergy(centred->problem->domain, &centred->iterate->place, image, &before, NULL));
  PetscCall(EqmAuthalicEnergy(solver->problem->domain, &solver->iterate->place, image, &least, NULL));
  CHECK(least < before, "area distortion %g, centred %g", (double)least, (double)before);
  for (PetscInt k = 0; k < 6; k++) {
    PetscReal c[3] = {0., 0., 0.};
    c[k / 2] = k % 2 ? -.003 : .003;
    PetscCall(EqmPlaceCopy(solver->problem->domain, &solver->iterate->place, &place));
    PetscCall(EqmPlaceShift(solver->problem->domain, c, &place));
    PetscCall(EqmAuthalicEnergy(solver->problem->domain, &place, image, &energy, NULL));
    CHECK(energy > least, "a shift makes %g of %g", (double)energy, (double)least);
  }
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(PetscFree(image));
  PetscCall(EqmSolverDestroy(&centred));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Landmarks that are a Mobius image of the map itself are met. */
static PetscErrorCode TestAlignFile(TestMesh *test)
{
  enum { N = 5 };
  const PetscInt vertex[N] = {5, 60, 111, 222, 300};
  const PetscReal turn[3] = {.3, 1., -.7}, pull[3] = {.2, -.3, .4};
  const EqmMoebius map = EqmMoebiusExponential(turn, pull);
  char file[64], options[128];
  PetscReal points[3 * N] = {0.}, sum[3 * N];
  EqmSolver solver;
  FILE *out;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(file, sizeof(file), "test_normalise.%d.csv", (int)test->mesh->size));
  PetscCall(PetscSNPrintf(options, sizeof(options), "-align %s", file));
  PetscCall(Solve(test, "", &solver));
  for (PetscInt v = 0; v < test->mesh->num_owned; v++) {
    for (PetscInt i = 0; i < N; i++) {
      if (test->mesh->vertex_input[v] == vertex[i])
        EqmMoebiusApply(&map, solver->iterate->place.x + 3 * v, points + 3 * i);
    }
  }
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(MPIU_Allreduce(points, sum, 3 * N, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  if (test->mesh->rank == 0) {
    out = fopen(file, "w");
    fprintf(out, "vertex,x,y,z\n");
    for (PetscInt i = 0; i < N; i++)
      fprintf(out, "%d,%.17g,%.17g,%.17g\n", (int)vertex[i], sum[3 * i], sum[3 * i + 1], sum[3 * i + 2]);
    fclose(out);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(Solve(test, options, &solver));
  CHECK_CLOSE(Off(solver, N, vertex, sum), 0., 1e-8, 1.);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(PetscStrlcat(options, " -align_rigid", sizeof(options)));
  PetscCall(Solve(test, options, &solver));
  CHECK(Off(solver, N, vertex, sum) > .05, "a rotation cannot do that");
  PetscCall(EqmSolverDestroy(&solver));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (test->mesh->rank == 0) unlink(file);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test, open;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestExponential());
  PetscCall(TestThrough());
  PetscCall(TestAlign());
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 500, 1, &test));
  PetscCall(TestFix(&test));
  PetscCall(TestArea(&test));
  PetscCall(TestAlignFile(&test));
  PetscCall(TestRefused(test.mesh, "conformal", "-fix 1,2"));
  PetscCall(TestRefused(test.mesh, "conformal", "-fix 1,2,1"));
  PetscCall(TestRefused(test.mesh, "conformal", "-fix 1,2,100000"));
  PetscCall(TestRefused(test.mesh, "conformal", "-fix 1,2,3 -fix_points 1,0,0"));
  PetscCall(TestRefused(test.mesh, "conformal", "-fix 1,2,3 -moebius area"));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "cap", 100, 1, &open));
  PetscCall(TestRefused(open.mesh, "conformal", "-moebius area"));
  PetscCall(TestMeshDestroy(&open));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
