/* First maps to the sphere: without folds on shapes of increasing difficulty, the same on any number of ranks, and what
   they are by definition where that is known. */
#include "support/runs.h"
#include "domain/domain_private.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "problem/term.h"
#include <math.h>

static PetscErrorCode Start(TestMesh *test, const char *options, EqmSolver *solver)
{
  char text[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "-method rgd -max_it 0 %s", options));
  PetscCall(TestSolve(test->mesh, "sphere", text, solver));
  for (PetscInt v = 0; v < test->mesh->num_local; v++) {
    const PetscReal *const x = (*solver)->iterate->place.x + 3 * v;
    CHECK_CLOSE(EqmDot3(x, x), 1., 1e-15, 1.);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode TestUnfolded(const char *shape, PetscInt n, const char *options)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 2, &test));
  PetscCall(Start(&test, options, &solver));
  CHECK(solver->iterate->totals.folds == 0, "%s %s: %d folds", shape, options, (int)solver->iterate->totals.folds);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* On the sphere itself normals are places, nearly. Turned inside out, the triangles keep their sense on the image. */
static PetscErrorCode TestNormals(PetscBool inside_out)
{
  TestMesh test;
  EqmSoup soup;
  EqmSolver solver;
  PetscReal farthest = 0.;

  PetscFunctionBegin;
  PetscCall(EqmSoupGenerate(PETSC_COMM_WORLD, "sphere", 1200, 2, &soup));
  for (PetscInt c = 0; c < soup->cell_end - soup->cell_start && inside_out; c++) {
    PetscInt *const v = soup->cells + 3 * c, first = v[0];
    v[0] = v[1];
    v[1] = first;
  }
  PetscCall(TestMeshFromSoup(soup, &test));
  PetscCall(Start(&test, "-start normals", &solver));
  CHECK(solver->iterate->totals.folds == 0, "%d folds", (int)solver->iterate->totals.folds);
  for (PetscInt k = 0; k < 3 * test.mesh->num_local; k++) {
    const PetscReal x = (inside_out ? -1. : 1.) * solver->iterate->place.x[k];
    farthest = PetscMax(farthest, PetscAbsReal(x - test.mesh->position[k]));
  }
  CHECK(farthest < .06, "a normal is %g away from the place on the sphere", (double)farthest);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The mesh on all ranks together and on each alone. */
static PetscErrorCode TestRanks(const char *start)
{
  char text[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "-method rgd -max_it 0 %s", start));
  PetscCall(TestSameOnRanks("head", 500, "sphere", text, 1e-9, 2.));
  PetscFunctionReturn(0);
}

/* The weight of corner a for corner b of a triangle with the other corner c, by the lengths of its sides. */
static PetscReal WeightFor(const char *kind, const PetscReal *a, const PetscReal *b, const PetscReal *c)
{
  PetscReal squared[3] = {0., 0., 0.}; /* of the sides opposite a, b, c */

  for (PetscInt k = 0; k < 3; k++) {
    squared[0] += PetscSqr(b[k] - c[k]);
    squared[1] += PetscSqr(c[k] - a[k]);
    squared[2] += PetscSqr(a[k] - b[k]);
  }
  const PetscReal at_a = acos((squared[1] + squared[2] - squared[0]) / (2. * PetscSqrtReal(squared[1] * squared[2])));
  const PetscReal at_c = acos((squared[0] + squared[1] - squared[2]) / (2. * PetscSqrtReal(squared[0] * squared[1])));
  if (!strcmp(kind, "uniform")) return 1.;
  if (!strcmp(kind, "harmonic")) return 1. / tan(at_c);
  if (!strcmp(kind, "semi-cotangent")) return 1. / tan(.5 * at_c);
  return tan(.5 * at_a) / PetscSqrtReal(squared[2]);
}

/* Stereographic images of vertices whose neighbours are all in the same hemisphere are the means of those of the
   neighbours; nothing is folded. */
static PetscErrorCode TestHemisphereWeights(const char *kind)
{
  TestMesh test;
  EqmSolver solver;
  PetscReal *sum, worst = 0.;
  PetscBool *cut;
  char options[96];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "-start tutte -start_weights %s", kind));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 900, 2, &test));
  PetscCall(Start(&test, options, &solver));
  CHECK(solver->iterate->totals.folds == 0, "%s: %d folds", kind, (int)solver->iterate->totals.folds);
  const EqmMesh mesh = test.mesh;
  const PetscReal *const x = solver->iterate->place.x;
  PetscCall(PetscCalloc2(3 * mesh->num_local, &sum, mesh->num_local, &cut));
  for (PetscInt k = 0; k < 6 * mesh->num_local_cells; k++) {
    const PetscInt *const v = mesh->cells + 3 * (k / 6), a = v[k % 3], b = v[(k % 3 + 1 + k / 3 % 2) % 3],
                          c = v[(k % 3 + 2 - k / 3 % 2) % 3];
    const PetscReal *const p = mesh->position, w = WeightFor(kind, p + 3 * a, p + 3 * b, p + 3 * c);
    cut[a] = (PetscBool)(cut[a] || x[3 * a + 2] * x[3 * b + 2] <= 0.);
    for (PetscInt d = 0; d < 2; d++)
      sum[3 * a + d] +=
          w * (x[3 * b + d] / (1. + PetscAbsReal(x[3 * b + 2])) - x[3 * a + d] / (1. + PetscAbsReal(x[3 * a + 2])));
    sum[3 * a + 2] += PetscAbsReal(w);
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt d = 0; d < 2 && !cut[v]; d++) worst = PetscMax(worst, PetscAbsReal(sum[3 * v + d]) / sum[3 * v + 2]);
  }
  CHECK(worst < 1e-12, "%s: a vertex is %g away from the mean of its neighbours", kind, (double)worst);
  PetscCall(PetscFree2(sum, cut));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* How unequal the solid angles of a start are, sum w (r - 1)^2. */
static PetscErrorCode SolidAngleSquares(TestMesh *test, const char *options, PetscReal *squares)
{
  const EqmMesh mesh = test->mesh;
  PetscReal *angle, sum = 0.;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(Start(test, options, &solver));
  CHECK(solver->iterate->totals.folds == 0, "%s: %d folds", options, (int)solver->iterate->totals.folds);
  CHECK(solver->problem->domain->measure == EQM_MEASURE_AREA3, "flat areas are not back");
  CHECK(!solver->problem->terms, "a term is left");
  PetscCall(PetscMalloc1(mesh->num_local_cells, &angle));
  PetscCall(EqmImageMeasureOf(solver->problem->domain, EQM_MEASURE_SOLID_ANGLE, &solver->iterate->place, angle));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++)
    sum += mesh->weight[c] * PetscSqr(angle[c] / (4. * PETSC_PI * mesh->weight[c]) - 1.);
  *squares = TestSum(mesh->comm, sum);
  PetscCall(PetscFree(angle));
  PetscCall(EqmSolverDestroy(&solver));
  PetscFunctionReturn(0);
}

/* Where there are limbs the start by solid angles makes these nearly equal, which the cascade it comes from does not.
 */
static PetscErrorCode TestSolidAngleStart(void)
{
  TestMesh test;
  PetscReal before, after;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "starfish", 900, 1, &test));
  PetscCall(SolidAngleSquares(&test, "-start cascade", &before));
  PetscCall(SolidAngleSquares(&test, "-start solid-angle", &after));
  CHECK(after < .2 * before, "from %g to %g", (double)before, (double)after);
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* -start_center leaves no mass centre. */
static PetscErrorCode TestCentered(const char *start)
{
  TestMesh test;
  EqmSolver solver;
  PetscReal *mass, center[3];

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 500, 1, &test));
  PetscCall(Start(&test, start, &solver));
  PetscCall(PetscMalloc1(test.mesh->num_owned, &mass));
  PetscCall(EqmMeshVertexWeights(test.mesh, mass));
  PetscCall(EqmPlaceMassCenter(solver->problem->domain, mass, &solver->iterate->place, center));
  CHECK(EqmDot3(center, center) < 1e-24, "the mass centre is off by %g",
        (double)PetscSqrtReal(EqmDot3(center, center)));
  PetscCall(PetscFree(mass));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* The iteration's own end, where the energy would rise, is success and says so (001 Algorithm 2). */
static PetscErrorCode TestFixedPointEnds(void)
{
  TestMesh test;
  EqmSolver solver;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 700, 1, &test));
  PetscCall(TestSolve(test.mesh, "sphere", "-method fixed-point -energy_rtol 0", &solver));
  CHECK(solver->status == EQM_STATUS_CONVERGED && solver->iterate->number < 100, "status %d after %d iterations: %s",
        (int)solver->status, (int)solver->iterate->number, solver->message);
  CHECK(strstr(solver->message, "raise the energy"), "%s", solver->message);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestNormals(PETSC_FALSE));
  PetscCall(TestNormals(PETSC_TRUE));
  PetscCall(TestUnfolded("head", 900, "-start gauss"));
  PetscCall(TestUnfolded("sphere", 900, "-start tutte"));
  PetscCall(TestUnfolded("head", 900, "-start tutte"));
  PetscCall(TestUnfolded("starfish", 900, "-start tutte"));
  PetscCall(TestUnfolded("head", 900, "-start tutte -start_steps 2"));
  PetscCall(TestHemisphereWeights("uniform"));
  PetscCall(TestHemisphereWeights("harmonic"));
  PetscCall(TestHemisphereWeights("mean-value"));
  PetscCall(TestHemisphereWeights("semi-cotangent"));
  PetscCall(TestRanks("-start gauss"));
  PetscCall(TestRanks("-start tutte"));
  PetscCall(TestRanks("-start tutte -start_weights mean-value"));
  PetscCall(TestSolidAngleStart());
  PetscCall(TestCentered("-start tutte -start_center"));
  PetscCall(TestCentered("-start linear -start_center"));
  PetscCall(TestFixedPointEnds());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
