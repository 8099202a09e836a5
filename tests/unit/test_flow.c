/* The heat flow of harmonic maps and the implicit Euler method's system (004 (7), (8), Appendix); matrices that are not
   positive definite. */
#include "support/testing.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "method/flow.h"

typedef struct {
  TestMesh test;
  EqmSolver solver;
  EqmDomain domain;
  const PetscReal *weights;
} Setting;

static PetscErrorCode Begin(Setting *s)
{
  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "head", 400, 3, &s->test));
  PetscCall(TestSolve(s->test.mesh, "conformal", "-max_it 0 -start tutte", &s->solver));
  s->domain = s->solver->problem->domain;
  PetscCall(EqmProblemGetAngleWeights(s->solver->problem, &s->weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode End(Setting *s)
{
  PetscFunctionBegin;
  PetscCall(EqmSolverDestroy(&s->solver));
  PetscCall(TestMeshDestroy(&s->test));
  PetscFunctionReturn(0);
}

/* The speed is the norm of the Dirichlet energy's gradient along the sphere. */
static PetscErrorCode TestSpeed(Setting *s)
{
  PetscReal *af, speed, norm;
  Vec gradient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * s->test.mesh->num_owned, &af));
  PetscCall(EqmDomainCreateVec(s->domain, &gradient));
  PetscCall(EqmFlowLaplacian(s->solver->problem, &s->solver->iterate->place, af, NULL));
  PetscCall(EqmDomainProject(s->domain, &s->solver->iterate->place, af, gradient));
  PetscCall(VecNorm(gradient, NORM_2, &norm));
  PetscCall(EqmFlowSpeed(s->solver->problem, &s->solver->iterate->place, &speed));
  CHECK_CLOSE(speed, norm, 1e-12, norm);
  CHECK(norm > .1, "speed %g", (double)norm);
  PetscCall(VecDestroy(&gradient));
  PetscCall(PetscFree(af));
  PetscFunctionReturn(0);
}

/* Adds a cell's matrix times `u` to `product`, for owned vertices. */
static void AddProduct(EqmMesh mesh, PetscInt cell, const PetscReal matrix[81], const PetscReal *u, PetscReal *product)
{
  for (PetscInt i = 0; i < 9; i++) {
    const PetscInt v = mesh->cells[3 * cell + i / 3];
    for (PetscInt j = 0; j < 9 && v < mesh->num_owned; j++)
      product[3 * v + i % 3] += matrix[9 * i + j] * u[3 * mesh->cells[3 * cell + j / 3] + j % 3];
  }
}

/* Jacobian times a direction by differences of the residual, at places off the sphere. The residual is cubic:
   differences of fourth order are exact but for rounding. */
static PetscErrorCode TestJacobian(Setting *s)
{
  const EqmMesh mesh = s->test.mesh;
  const PetscInt n = 3 * mesh->num_owned;
  const PetscReal h = .1;
  PetscReal *u, *product, *at[4], matrix[81];
  EqmPlace place, moved;
  EqmImplicitStep step = {.problem = s->solver->problem, .weights = s->weights, .place = &place, .dt = 1.7};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * mesh->num_local, &u));
  PetscCall(PetscCalloc1(n, &product));
  PetscCall(EqmPlaceCreate(s->domain, &place));
  PetscCall(EqmPlaceCreate(s->domain, &moved));
  for (PetscInt k = 0; k < n; k++) {
    place.x[k] = s->solver->iterate->place.x[k] + .2 * TestRandom(1, mesh->vertex_input[k / 3], k % 3);
    u[k] = TestRandom(2, mesh->vertex_input[k / 3], k % 3);
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, place.x));
  PetscCall(EqmMeshUpdateGhosts(mesh, 3, u));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    EqmImplicitCell(&step, c, matrix);
    AddProduct(mesh, c, matrix, u, product);
  }
  step.place = &moved;
  for (int d = 0; d < 4; d++) {
    for (PetscInt k = 0; k < 3 * mesh->num_local; k++) moved.x[k] = place.x[k] + (d < 2 ? d - 2 : d - 1) * h * u[k];
    PetscCall(PetscMalloc1(n, &at[d]));
    PetscCall(EqmImplicitResidual(&step, &s->solver->iterate->place, at[d]));
  }
  for (PetscInt k = 0; k < n; k++) /* the identity is added as a shift */
    CHECK_CLOSE((8. * (at[2][k] - at[1][k]) - (at[3][k] - at[0][k])) / (12. * h), product[k] + u[k], 1e-10, 10.);
  for (int d = 0; d < 4; d++) PetscCall(PetscFree(at[d]));
  PetscCall(EqmPlaceDestroy(&place));
  PetscCall(EqmPlaceDestroy(&moved));
  PetscCall(PetscFree(u));
  PetscCall(PetscFree(product));
  PetscFunctionReturn(0);
}

/* A cell's part of a matrix of either kind, with entries at random. */
typedef struct {
  EqmMesh mesh;
  PetscBool symmetric;
} RandomMatrix;

static void CellEntries(void *context, PetscInt cell, PetscReal *matrix)
{
  const RandomMatrix *const r = context;

  for (PetscInt k = 0; k < 9; k++) matrix[k] = TestRandom(3, r->mesh->cell_input[cell], k);
  for (PetscInt k = 0; k < 9 && r->symmetric; k++)
    matrix[k] = TestRandom(3, r->mesh->cell_input[cell], PetscMin(3 * (k / 3) + k % 3, 3 * (k % 3) + k / 3));
}

/* What is solved is solved, whichever signs the eigenvalues have; a second matrix of the same pattern too. */
static PetscErrorCode TestGeneral(Setting *s, PetscBool symmetric)
{
  const EqmMesh mesh = s->test.mesh;
  const PetscInt n = mesh->num_owned;
  RandomMatrix random = {mesh, symmetric};
  unsigned char *count;
  PetscReal *x, *columns, matrix[9];
  EqmUnknowns unknowns = {.num_owned = n, .first = mesh->vertex_start, .start = mesh->global};
  EqmGeneral general;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_local, &count, mesh->num_local, &x, 2 * n, &columns));
  for (PetscInt v = 0; v < mesh->num_local; v++) count[v] = 1;
  unknowns.count = count;
  PetscCall(EqmGeneralCreate(mesh, &unknowns, symmetric, PETSC_FALSE, &general));
  for (int round = 0; round < 2; round++) {
    const PetscReal shift = round ? -.3 : .4;
    PetscBool success;
    PetscCall(EqmGeneralFactor(general, CellEntries, &random, shift, &success));
    CHECK(success, "the factorisation failed");
    for (PetscInt v = 0; v < n; v++) x[v] = TestRandom(5, mesh->vertex_input[v], round);
    PetscCall(EqmMeshUpdateGhosts(mesh, 1, x));
    for (PetscInt v = 0; v < n; v++) columns[v] = shift * x[v];
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
      CellEntries(&random, c, matrix);
      for (PetscInt k = 0; k < 9; k++) {
        const PetscInt i = mesh->cells[3 * c + k / 3], j = mesh->cells[3 * c + k % 3];
        if (i < n) columns[i] += matrix[k] * x[j];
      }
    }
    for (PetscInt v = 0; v < n; v++) columns[n + v] = -2. * columns[v];
    PetscCall(EqmGeneralSolve(general, 2, columns));
    for (PetscInt v = 0; v < n; v++) {
      CHECK_CLOSE(columns[v], x[v], 1e-8, 1.);
      CHECK_CLOSE(columns[n + v], -2. * x[v], 2e-8, 1.);
    }
  }
  PetscCall(EqmGeneralDestroy(&general));
  PetscCall(PetscFree3(count, x, columns));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Setting s;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(Begin(&s));
  PetscCall(TestSpeed(&s));
  PetscCall(TestJacobian(&s));
  PetscCall(TestGeneral(&s, PETSC_TRUE));
  PetscCall(TestGeneral(&s, PETSC_FALSE));
  PetscCall(End(&s));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
