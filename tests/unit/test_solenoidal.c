/* Smooth motions without compression, the coarse space of the metric of solids: the fields have no divergence and stay
   on the sphere; the matrix is Galerkin's; the same for any number of threads and ranks; it makes multigrid as good as
   factors. */
#include "support/testing.h"
#include "problem/solenoidal_private.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "mesh/mesh_private.h"
#include <omp.h>

/* Field f of a spline at x. */
static void Velocity(const PetscReal x[3], PetscInt place, PetscInt f, PetscReal velocity[3])
{
  EqmSplines s;

  EqmSplinesAt(x, &s);
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal along[3] = {k == 0, k == 1, k == 2};
    PetscReal product[EQM_FIELDS_PER_SPLINE][EQM_SPLINES_AT_POINT];
    EqmSolenoidalAgainst(&s, x, along, product);
    velocity[k] = 0.;
    for (PetscInt m = 0; m < EQM_SPLINES_AT_POINT; m++) {
      if (EqmSplinePlace(s.base[0] - 1 + m / 9, s.base[1] - 1 + m / 3 % 3, s.base[2] - 1 + m % 3) == place)
        velocity[k] = product[f][m];
    }
  }
}

/* By central differences. */
static PetscReal Divergence(const PetscReal x[3], PetscInt place, PetscInt f)
{
  const PetscReal h = 1e-5;
  PetscReal sum = 0.;

  for (PetscInt k = 0; k < 3; k++) {
    PetscReal before[3] = {x[0], x[1], x[2]}, behind[3] = {x[0], x[1], x[2]}, u[3], v[3];
    before[k] -= h;
    behind[k] += h;
    Velocity(before, place, f, u);
    Velocity(behind, place, f, v);
    sum += (v[k] - u[k]) / (2. * h);
  }
  return sum;
}

static void CheckFields(void)
{
  PetscReal largest = 0.;

  for (PetscInt n = 0; n < 60; n++) {
    PetscReal x[3], length = 0.;
    EqmSplines s;
    for (PetscInt k = 0; k < 3; k++) x[k] = TestRandom(3, n, k);
    for (PetscInt k = 0; k < 3; k++) length += x[k] * x[k];
    for (PetscInt k = 0; k < 3; k++) x[k] *= (n % 2 ? 1. : .9) / PetscSqrtReal(length);
    EqmSplinesAt(x, &s);
    const PetscInt place = EqmSplinePlace(s.base[0] - n % 3 / 2, s.base[1], s.base[2] + n % 2);
    for (PetscInt f = 0; f < EQM_FIELDS_PER_SPLINE; f++) {
      PetscReal u[3];
      Velocity(x, place, f, u);
      largest = PetscMax(largest, PetscAbsReal(u[0]));
      CHECK_CLOSE(Divergence(x, place, f), 0., 1e-8, 1.);
      if (n % 2) CHECK_CLOSE(u[0] * x[0] + u[1] * x[1] + u[2] * x[2], 0., 1e-14, 1.);
    }
  }
  CHECK(largest > .1, "all fields are next to zero");
}

typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmProblem problem;
  EqmPlace place;
  PetscReal *weights;
  EqmSolenoidal space;
  Vec g, h;
} Case;

/* A gradient: random cells grow and shrink. Rotations, which change none, have no part in it. */
static PetscErrorCode MakeGradient(Case *c)
{
  const EqmMesh mesh = c->mesh.mesh;
  const PetscReal *const x = c->place.x;
  PetscReal *ambient;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * mesh->num_local, &ambient));
  for (PetscInt cell = 0; cell < mesh->num_local_cells; cell++) {
    const PetscInt *const v = mesh->cells + 4 * cell;
    const PetscReal *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
    const PetscReal growth = TestRandom(7, mesh->cell_input[cell], 0);
    PetscReal gradient[4][3];
    EqmVolumeGradient(p, gradient[0]);
    for (PetscInt a = 0; a < 4; a++) {
      for (PetscInt k = 0; k < 3; k++) ambient[3 * v[a] + k] += growth * gradient[a][k];
    }
  }
  PetscCall(EqmDomainProject(c->domain, &c->place, ambient, c->g));
  PetscCall(PetscFree(ambient));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseCreate(MPI_Comm comm, Case *c)
{
  PetscInt edges;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(comm, "ball", 3000, 1, &c->mesh));
  PetscCall(EqmDomainCreate(c->mesh.mesh, "ball", NULL, &c->domain));
  PetscCall(EqmProblemCreate(c->domain, &EqmObjectiveAuthalic, &c->problem));
  PetscCall(EqmPlaceCreate(c->domain, &c->place));
  PetscCall(TestShakenBall(c->domain, 5, .005, &c->place));
  edges = EqmCellNumEdges(4);
  PetscCall(PetscMalloc1(edges * c->mesh.mesh->num_local_cells, &c->weights));
  PetscCall(EqmLaplacianWeights(c->domain, EQM_LAPLACIAN_STRETCH, &c->place, c->weights));
  PetscCall(EqmSolenoidalCreate(c->problem, &c->space));
  PetscCall(EqmDomainCreateVec(c->domain, &c->g));
  PetscCall(VecDuplicate(c->g, &c->h));
  PetscCall(MakeGradient(c));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseDestroy(Case *c)
{
  PetscFunctionBegin;
  PetscCall(VecDestroy(&c->g));
  PetscCall(VecDestroy(&c->h));
  PetscCall(EqmSolenoidalDestroy(&c->space));
  PetscCall(PetscFree(c->weights));
  PetscCall(EqmPlaceDestroy(&c->place));
  PetscCall(EqmProblemDestroy(&c->problem));
  PetscCall(TestMeshDestroy(&c->mesh));
  PetscFunctionReturn(0);
}

static PetscErrorCode Correct(Case *c, PetscReal share)
{
  PetscFunctionBegin;
  PetscCall(EqmSolenoidalFactor(c->space, &c->place, c->weights, share));
  PetscCall(VecZeroEntries(c->h));
  PetscCall(EqmSolenoidalSolve(c->space, &c->place, c->g));
  PetscCall(EqmSolenoidalAdd(c->space, &c->place, c->h));
  PetscFunctionReturn(0);
}

/* h^T (sum g g^T / w + share L) h, cell by cell. */
static PetscErrorCode EnergyOf(Case *c, PetscReal share, PetscReal *energy)
{
  const EqmMesh mesh = c->mesh.mesh;
  const PetscReal *const x = c->place.x;
  PetscReal *motion, sum = 0., laplacian;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * mesh->num_local, &motion));
  PetscCall(EqmDomainExpand(c->domain, &c->place, c->h, motion));
  for (PetscInt cell = 0; cell < mesh->num_owned_cells; cell++) {
    const PetscInt *const v = mesh->cells + 4 * cell;
    const PetscReal *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
    PetscReal gradient[4][3], change = 0.;
    EqmVolumeGradient(p, gradient[0]);
    for (PetscInt a = 0; a < 4; a++) {
      for (PetscInt k = 0; k < 3; k++) change += gradient[a][k] * motion[3 * v[a] + k];
    }
    sum += change * change / mesh->weight[cell];
  }
  PetscCall(EqmLaplacianEnergy(mesh, c->weights, 3, motion, &laplacian));
  *energy = TestSum(mesh->comm, sum) + 2. * share * laplacian;
  PetscCall(PetscFree(motion));
  PetscFunctionReturn(0);
}

/* h = P (P^T A P)^-1 P^T g has g^T h = h^T A h. So small a mesh has no samples. */
static PetscErrorCode CheckGalerkin(Case *c)
{
  const PetscReal share[] = {0., 1.};
  PetscReal energy, product;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(Correct(c, share[k]));
    PetscCall(EnergyOf(c, share[k], &energy));
    PetscCall(VecDot(c->g, c->h, &product));
    CHECK(energy > 0., "no correction");
    CHECK_CLOSE(product, energy, 1e-6, energy);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckThreadsAndRanks(Case *c)
{
  const PetscInt threads = omp_get_max_threads();
  PetscReal product, alone_product;
  PetscBool equal;
  Case alone;
  Vec first;

  PetscFunctionBegin;
  PetscCall(Correct(c, .01));
  PetscCall(VecDuplicate(c->h, &first));
  PetscCall(VecCopy(c->h, first));
  omp_set_num_threads(3);
  PetscCall(Correct(c, .01));
  omp_set_num_threads((int)threads);
  PetscCall(VecEqual(c->h, first, &equal));
  CHECK(equal, "three threads give another result");
  PetscCall(VecDot(c->g, c->h, &product));
  PetscCall(CaseCreate(PETSC_COMM_SELF, &alone));
  PetscCall(Correct(&alone, .01));
  PetscCall(VecDot(alone.g, alone.h, &alone_product));
  CHECK_CLOSE(product, alone_product, 1e-5, alone_product);
  PetscCall(CaseDestroy(&alone));
  PetscCall(VecDestroy(&first));
  PetscFunctionReturn(0);
}

/* As many iterations as a factor takes nearly lead to the minimum, 5.5528e-5 for this solid. */
static PetscErrorCode CheckIterations(void)
{
  const EqmHistoryRow *row;
  EqmSolver solver;
  TestMesh test;
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "blob", 3375, 0, &test));
  PetscCall(TestSolve(test.mesh, "ball", "-linear_solver multigrid -max_it 40 -energy_rtol 0", &solver));
  PetscCall(EqmSolverGetHistory(solver, &count, &row));
  CHECK(row[count - 1].energy < 5.8e-5, "E %g after %d iterations", (double)row[count - 1].energy, (int)count - 1);
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Case c;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  CheckFields();
  PetscCall(CaseCreate(PETSC_COMM_WORLD, &c));
  PetscCall(CheckGalerkin(&c));
  PetscCall(CheckThreadsAndRanks(&c));
  PetscCall(CaseDestroy(&c));
  PetscCall(CheckIterations());
  PetscCall(PetscFinalize());
  return 0;
}
