/* -linear_solver hierarchy: solutions are those of a factor, on any number of ranks, with the levels on the first of
   them or shared; cycles are few, and hardly more on a mesh four times as large. */
#include "support/testing.h"
#include "energy/cellframe.h"
#include "linalg/onshared.h"
#include "problem/levels.h"
#include "problem/objective.h"

/* A map without folds, and the degrees of freedom of its motions. */
typedef struct {
  TestMesh mesh;
  EqmProblem problem;
  EqmPlace place;
  PetscReal damping;
  EqmShared shared; /* or NULL: the levels are the problem's */
} Case;

static PetscErrorCode CaseCreate(const char *shape, PetscInt n, const char *target, Case *test)
{
  EqmCascadeOptions options;
  EqmCascadeResult result;
  EqmLevels *levels;
  EqmDomain domain;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 1, &test->mesh));
  PetscCall(EqmDomainCreate(test->mesh.mesh, target, NULL, &domain));
  PetscCall(EqmProblemCreate(domain, &EqmObjectiveAuthalic, &test->problem));
  PetscCall(EqmPlaceCreate(domain, &test->place));
  PetscCall(EqmDomainPlaceBoundary(domain, &test->place));
  PetscCall(EqmCascadeOptionsDefault(&options));
  PetscCall(EqmProblemGetLevels(test->problem, &levels));
  PetscCall(EqmLevelsCascade(levels, &options, &test->place, &result));
  CHECK(result.folds == 0, "%d folds", (int)result.folds);
  PetscCall(EqmPlaceMakeFrames(domain, &test->place));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseDestroy(Case *test)
{
  PetscFunctionBegin;
  PetscCall(EqmSharedDestroy(&test->shared));
  PetscCall(EqmPlaceDestroy(&test->place));
  PetscCall(EqmProblemDestroy(&test->problem));
  PetscCall(TestMeshDestroy(&test->mesh));
  PetscFunctionReturn(0);
}

/* A solver on the problem's levels, which are on the first rank; or on levels of small pieces that all ranks share. */
static PetscErrorCode CreateLinear(Case *test, PetscBool shared, EqmLinear *linear)
{
  const EqmUnknowns unknowns = EqmDomainUnknowns(test->problem->domain);
  const EqmMesh mesh = test->problem->mesh;
  EqmHierarchyOptions options;
  EqmLevels *levels;
  PetscBool *corner;

  PetscFunctionBegin;
  if (!shared) {
    PetscCall(EqmProblemCreateLinearOnLevels(test->problem, linear));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmProblemGetLevels(test->problem, &levels));
  PetscCall(PetscMalloc1(mesh->num_local, &corner));
  for (PetscInt v = 0; v < mesh->num_local; v++)
    corner[v] = (PetscBool)(EqmDomainMotion(test->problem->domain, v) == &EqmMotionCorner);
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.corner = corner;
  options.gathered = options.vertices_of_piece = 300;
  PetscCall(EqmSharedCreate(mesh, &options, &test->shared));
  PetscCall(PetscFree(corner));
  PetscCall(EqmLinearCreateOnShared(mesh, &unknowns, test->shared, levels->target, linear));
  PetscFunctionReturn(0);
}

/* What Gauss-Newton makes of equal areas, and a Laplacian: stiff for compression and soft for all else. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const Case *const test = context;
  const EqmDomain domain = test->problem->domain;
  const EqmMesh mesh = test->problem->mesh;
  const PetscInt *const v = mesh->cells + 3 * cell, dim = domain->dim;
  const PetscReal *const x = test->place.x, *const p[] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
  PetscReal area[3 * EQM_MAX_CORNERS], gradient[4][3] = {{0.}}, laplacian[4][4] = {{0.}};
  EqmCellFrame frame;

  EqmCellFrameFind(domain, &test->place, cell, &frame);
  EqmMeasureGradient(domain->measure, p, area);
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt k = 0; k < dim; k++) gradient[a][k] = area[dim * a + k];
    for (PetscInt b = 0; b < 3; b++) laplacian[a][b] = a == b ? 2. / 3. : -1. / 3.;
  }
  for (PetscInt k = 0; k < frame.count * frame.count; k++) matrix[k] = 0.;
  EqmCellFrameAddSquare(&frame, 1. / (mesh->weight[cell] * PetscSqr(domain->target_measure)), gradient, matrix);
  EqmCellFrameAddLaplacian(&frame, test->damping, laplacian, matrix);
}

/* A right-hand side that is the same on any number of ranks; rotations of the sphere cost next to nothing, and a force
   along them would move it far. */
static PetscErrorCode MakeForce(const Case *test, PetscReal *force)
{
  const EqmDomain domain = test->problem->domain;
  const EqmMesh mesh = test->problem->mesh;
  const PetscScalar *array;
  PetscReal *ambient;
  Vec dofs;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(domain->dim * mesh->num_owned, &ambient));
  PetscCall(EqmDomainCreateVec(domain, &dofs));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < domain->dim; k++) ambient[domain->dim * v + k] = TestRandom(5, mesh->vertex_input[v], k);
  }
  PetscCall(EqmDomainProject(domain, &test->place, ambient, dofs));
  PetscCall(VecGetArrayRead(dofs, &array));
  PetscCall(PetscArraycpy(force, array, domain->num_dofs));
  PetscCall(VecRestoreArrayRead(dofs, &array));
  PetscCall(VecDestroy(&dofs));
  PetscCall(PetscFree(ambient));
  PetscFunctionReturn(0);
}

/* sqrt of the sum of squares over all ranks. */
static PetscErrorCode Norm(PetscInt n, const PetscReal *x, PetscReal *norm)
{
  PetscReal sum = 0.;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) sum += PetscSqr(x[k]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  *norm = PetscSqrtReal(sum);
  PetscFunctionReturn(0);
}

/* Iterations that a tolerance takes; x is the solution. */
static PetscErrorCode Solve(const Case *test, EqmLinear linear, PetscReal tolerance, const PetscReal *b, PetscReal *x,
                            PetscInt64 *iterations)
{
  PetscBool success;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(test->mesh.ledger, &work));
  *iterations = work->cg_iterations;
  PetscCall(EqmLinearSetInexact(linear, tolerance));
  PetscCall(EqmLinearTrySolve(linear, 1, b, x, &success));
  CHECK(success, "no solution");
  *iterations = work->cg_iterations - *iterations;
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSolution(const char *shape, PetscInt n, const char *target, PetscBool shared, PetscInt64 most)
{
  Case test = {.damping = 5e-3};
  PetscReal *b, *x, *direct, norm, difference;
  PetscInt64 iterations;
  PetscInt num_dofs;
  PetscBool success;
  EqmLinear linear;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(CaseCreate(shape, n, target, &test));
  PetscCall(EqmLedgerGetWork(test.mesh.ledger, &work));
  num_dofs = test.problem->domain->num_dofs;
  PetscCall(PetscMalloc3(num_dofs, &b, num_dofs, &x, num_dofs, &direct));
  PetscCall(MakeForce(&test, b));
  PetscCall(CreateLinear(&test, shared, &linear));
  PetscCall(EqmProblemSetImage(test.problem, &test.place, linear));
  for (PetscInt pass = 0; pass < 2; pass++) { /* the second matrix takes the patterns of the first */
    PetscCall(EqmLinearFactor(linear, CellMatrix, &test, 1. + 1e-12, &success));
    CHECK(success, "no cycle");
  }
  CHECK(work->set_ups == 2 && work->coupled_factorizations == 0, "%d set-ups, %d factorisations", (int)work->set_ups,
        (int)work->coupled_factorizations);
  PetscCall(Solve(&test, linear, 1e-2, b, x, &iterations));
  CHECK(iterations > 0 && iterations <= most, "%s of %d vertices to the %s: %d cycles", shape, (int)n, target,
        (int)iterations);
  PetscCall(Solve(&test, linear, 1e-9, b, x, &iterations));
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(EqmProblemCreateLinear(test.problem, EQM_MATRIX_COUPLED, &linear));
  PetscCall(EqmLinearFactor(linear, CellMatrix, &test, 1. + 1e-12, &success));
  CHECK(success && work->coupled_factorizations == 1, "no factor");
  PetscCall(EqmLinearSolve(linear, 1, b, direct));
  PetscCall(Norm(num_dofs, direct, &norm));
  for (PetscInt k = 0; k < num_dofs; k++) x[k] -= direct[k];
  PetscCall(Norm(num_dofs, x, &difference));
  CHECK(difference < 1e-6 * norm, "%s: %g of %g differ", target, (double)difference, (double)norm);
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(PetscFree3(b, x, direct));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

/* A matrix that is not definite is found to be none: no solution looks like one. */
static PetscErrorCode TestIndefinite(void)
{
  Case test = {.damping = -1e3};
  PetscBool success;
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(CaseCreate("hills", 2000, "disk", &test));
  PetscCall(EqmProblemCreateLinearOnLevels(test.problem, &linear));
  PetscCall(EqmProblemSetImage(test.problem, &test.place, linear));
  PetscCall(EqmLinearFactor(linear, CellMatrix, &test, 1., &success));
  CHECK(!success, "an indefinite matrix has cycles");
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(CaseDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSolution("hills", 2500, "disk", PETSC_FALSE, 11));
  PetscCall(TestSolution("hills", 10000, "disk", PETSC_FALSE, 11));
  PetscCall(TestSolution("hills", 2500, "disk", PETSC_TRUE, 13));
  PetscCall(TestSolution("patch", 2500, "square", PETSC_FALSE, 15));
  PetscCall(TestSolution("patch", 2500, "square", PETSC_TRUE, 17));
  PetscCall(TestSolution("head", 2500, "sphere", PETSC_FALSE, 7));
  PetscCall(TestSolution("head", 10000, "sphere", PETSC_FALSE, 7));
  PetscCall(TestSolution("head", 2500, "sphere", PETSC_TRUE, 9));
  PetscCall(TestIndefinite());
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
