/* Assembly and linear solvers: residuals of several right-hand sides, what happens to matrices that are not definite.
 */
#include "support/testing.h"
#include "support/cellmatrix.h"
#include <math.h>
#include <omp.h>
#include <string.h>

enum { MOST_RHS = 4 };

/* y = A x cell by cell, without a matrix; x and y per owned unknown. The diagonal is multiplied by `diagonal`. */
static PetscErrorCode ModelApply(TestMatrix *model, PetscReal diagonal, const PetscReal *x, PetscReal *y)
{
  const EqmMesh mesh = model->mesh;
  const EqmUnknowns *const u = &model->unknowns;
  PetscReal *by_vertex, matrix[EQM_MOST_CELL_UNKNOWNS * EQM_MOST_CELL_UNKNOWNS];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * mesh->num_local, &by_vertex));
  for (PetscInt v = 0; v < mesh->num_owned; v++) {
    for (PetscInt k = 0; k < u->count[v]; k++) by_vertex[2 * v + k] = x[u->start[v] - u->first + k];
  }
  PetscCall(EqmMeshUpdateGhosts(mesh, 2, by_vertex));
  PetscCall(PetscArrayzero(y, u->num_owned));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt row[EQM_MOST_CELL_UNKNOWNS], n = 0;
    PetscReal value[EQM_MOST_CELL_UNKNOWNS];
    for (PetscInt a = 0; a < mesh->cell_size; a++) {
      const PetscInt v = mesh->cells[mesh->cell_size * c + a];
      for (PetscInt k = 0; k < u->count[v]; k++) {
        value[n] = by_vertex[2 * v + k];
        row[n++] = u->start[v] + k - u->first;
      }
    }
    TestCellMatrix(model, c, matrix);
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt j = 0; j < n && row[i] >= 0 && row[i] < u->num_owned; j++)
        y[row[i]] += (i == j ? diagonal : 1.) * matrix[n * i + j] * value[j];
    }
  }
  PetscCall(PetscFree(by_vertex));
  PetscFunctionReturn(0);
}

static PetscReal Entry(PetscInt unknown, PetscInt column)
{
  return TestRandom(11, unknown, column);
}

/* |A x - b| <= tolerance |b|. */
static PetscErrorCode CheckResidual(TestMatrix *model, PetscReal diagonal, const PetscReal *b, const PetscReal *x,
                                    PetscReal tolerance)
{
  const PetscInt n = model->unknowns.num_owned;
  PetscReal *y, local[2] = {0., 0.};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &y));
  PetscCall(ModelApply(model, diagonal, x, y));
  for (PetscInt i = 0; i < n; i++) {
    local[0] += PetscSqr(y[i] - b[i]);
    local[1] += PetscSqr(b[i]);
  }
  CHECK_CLOSE(PetscSqrtReal(TestSum(PETSC_COMM_WORLD, local[0])), 0., tolerance,
              PetscSqrtReal(TestSum(PETSC_COMM_WORLD, local[1])));
  PetscCall(PetscFree(y));
  PetscFunctionReturn(0);
}

/* What stands for the inverse in a metric is linear, symmetric and definite: u B v = v B u, u B u > 0. */
static PetscErrorCode CheckApply(EqmLinear linear, TestMatrix *model)
{
  const PetscInt n = model->unknowns.num_owned;
  PetscReal *b, *x, product[4] = {0., 0., 0., 0.};

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(2 * n, &b, 2 * n, &x));
  for (PetscInt i = 0; i < 2 * n; i++) b[i] = Entry(model->unknowns.first + i % PetscMax(n, 1), 7 + i / PetscMax(n, 1));
  PetscCall(EqmLinearApply(linear, 2, b, x));
  for (PetscInt k = 0; k < 4; k++) {
    for (PetscInt i = 0; i < n; i++) product[k] += b[k / 2 * n + i] * x[k % 2 * n + i];
    product[k] = TestSum(PETSC_COMM_WORLD, product[k]);
  }
  CHECK(product[0] > 0. && product[3] > 0., "not definite: %g, %g", (double)product[0], (double)product[3]);
  CHECK_CLOSE(product[1], product[2], 1e-10, PetscSqrtReal(product[0] * product[3]));
  PetscCall(PetscFree2(b, x));
  PetscFunctionReturn(0);
}

/* Factor and solve. `in_place`: solutions over right-hand sides. */
static PetscErrorCode CheckSolve(EqmLinear linear, TestMatrix *model, PetscReal diagonal, PetscInt num_rhs,
                                 PetscBool in_place, PetscReal tolerance)
{
  const PetscInt n = model->unknowns.num_owned;
  PetscReal *b, *x;
  PetscBool success = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(MOST_RHS * n, &b, MOST_RHS * n, &x));
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, model, diagonal, &success));
  CHECK(success, "a definite matrix is refused");
  for (PetscInt k = 0; k < num_rhs; k++) {
    for (PetscInt i = 0; i < n; i++) b[k * n + i] = x[k * n + i] = Entry(model->unknowns.first + i, k);
  }
  PetscCall(EqmLinearSolve(linear, num_rhs, in_place ? x : b, x));
  for (PetscInt k = 0; k < num_rhs; k++) PetscCall(CheckResidual(model, diagonal, b + k * n, x + k * n, tolerance));
  PetscCall(PetscFree2(b, x));
  PetscFunctionReturn(0);
}

/* A matrix that is not definite is reported as such on every rank; a good one works again after it. */
static PetscErrorCode CheckIndefinite(EqmLinear linear, TestMatrix *model, PetscReal tolerance)
{
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  model->spoil = 1e3;
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, model, 1., &success));
  CHECK(!success, "an indefinite matrix passes for definite");
  model->spoil = 0.;
  PetscCall(CheckSolve(linear, model, 1., 2, PETSC_FALSE, tolerance));
  PetscFunctionReturn(0);
}

/* Multigrid cannot see it before the iteration: a true solution or an error, never numbers that solve nothing. */
static PetscErrorCode CheckIndefiniteMultigrid(EqmLinear linear, TestMatrix *model)
{
  const PetscInt n = model->unknowns.num_owned;
  PetscErrorCode error = 0;
  PetscReal *b, *x;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &b, n, &x));
  for (PetscInt i = 0; i < n; i++) b[i] = Entry(model->unknowns.first + i, 0);
  model->spoil = 1e3;
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, model, 1., &success));
  if (success) {
    PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    error = EqmLinearSolve(linear, 1, b, x);
    PetscCall(PetscPopErrorHandler());
    if (!error) PetscCall(CheckResidual(model, 1., b, x, 1e-8));
  }
  model->spoil = 0.;
  PetscCall(PetscFree2(b, x));
  PetscFunctionReturn(0);
}

/* One kind of solver on one set of unknowns. */
static PetscErrorCode TestSolver(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns, EqmMatrixUse use,
                                 const char *option)
{
  TestMatrix model = {.mesh = mesh, .unknowns = *unknowns, .shift = .5};
  EqmWork *work, before;
  PetscOptions options;
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(option, &options));
  PetscCall(EqmLinearCreate(mesh, ordering, unknowns, use, &linear));
  const PetscBool direct = (PetscBool)(linear->kind != EQM_SOLVER_MULTIGRID && linear->kind != EQM_SOLVER_PETSC);
  const PetscBool is_single = (PetscBool)(linear->is_single && direct && linear->kind != EQM_SOLVER_MUMPS);
  const PetscReal tolerance = is_single ? 1e-5 : direct ? 1e-12 : 1e-9;
  PetscCall(EqmLedgerGetWork(mesh->ledger, &work));
  before = *work;
  PetscCall(CheckSolve(linear, &model, 1., 3, PETSC_FALSE, tolerance));
  PetscCall(CheckSolve(linear, &model, 1., 1, PETSC_TRUE, tolerance));
  model.shift = .8; /* new values, same pattern */
  PetscCall(CheckSolve(linear, &model, 1., MOST_RHS, PETSC_TRUE, tolerance));
  PetscCall(CheckSolve(linear, &model, 1.5, 2, PETSC_FALSE, tolerance));
  CHECK(work->factorizations - before.factorizations == 4 && work->solves - before.solves == 10,
        "%d factorisations, %d solves", (int)(work->factorizations - before.factorizations),
        (int)(work->solves - before.solves));
  CHECK(work->coupled_factorizations - before.coupled_factorizations == (use == EQM_MATRIX_SCALAR ? 0 : 4),
        "%d coupled", (int)(work->coupled_factorizations - before.coupled_factorizations));
  PetscCall(CheckApply(linear, &model));
  if (direct)
    PetscCall(CheckIndefinite(linear, &model, tolerance));
  else
    PetscCall(CheckIndefiniteMultigrid(linear, &model));
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* Factors for steps: single precision, half the memory and no more digits than that, and double on demand. */
static PetscErrorCode TestPrecision(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns)
{
  static const char *const precisions[] = {"-linear_precision single", "-linear_precision double"};
  TestMatrix model = {.mesh = mesh, .unknowns = *unknowns, .shift = .5};
  PetscReal bytes[2], error[2], *b, *x;
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(unknowns->num_owned, &b, unknowns->num_owned, &x));
  for (PetscInt k = 0; k < 2; k++) {
    PetscOptions options;
    PetscBool success;
    PetscCall(TestOptionsBegin(precisions[k], &options));
    PetscCall(EqmLinearCreate(mesh, ordering, unknowns, EQM_MATRIX_STEP, &linear));
    PetscCall(EqmLinearFactor(linear, TestCellMatrix, &model, 1., &success));
    CHECK(success, "a definite matrix is refused");
    bytes[k] = linear->estimate.bytes;
    for (PetscInt i = 0; i < unknowns->num_owned; i++) b[i] = x[i] = Entry(unknowns->first + i, 5);
    PetscCall(EqmLinearSolveStep(linear, x));
    PetscCall(CheckResidual(&model, 1., b, x, k == 0 ? 1e-5 : 1e-12));
    PetscCall(ModelApply(&model, 1., x, x));
    error[k] = 0.;
    for (PetscInt i = 0; i < unknowns->num_owned; i++) error[k] = PetscMax(error[k], PetscAbsReal(x[i] - b[i]));
    PetscCall(EqmLinearDestroy(&linear));
    PetscCall(TestOptionsEnd(&options));
  }
  CHECK(TestSum(PETSC_COMM_WORLD, error[0]) > 1e3 * TestSum(PETSC_COMM_WORLD, error[1]),
        "single precision has as many digits as double");
  /* a front at work is in double; in the small parts of more ranks it takes what the others save */
  CHECK(mesh->size > 3 || bytes[0] < bytes[1], "single precision takes %g bytes, double %g", (double)bytes[0],
        (double)bytes[1]);
  PetscCall(PetscFree2(b, x));
  PetscFunctionReturn(0);
}

/* Solvers of one rank on several are a usage error. */
static PetscErrorCode TestOnSeveralRanks(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns,
                                         const char *option)
{
  PetscOptions options;
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(option, &options));
  CHECK_FAILS(EQM_ERR_USAGE, EqmLinearCreate(mesh, ordering, unknowns, EQM_MATRIX_SCALAR, &linear));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* Estimates precede the factorisation; with too little memory the solver is iterative, or fails with a message. */
static PetscErrorCode TestMemory(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns)
{
  PetscOptions options;
  EqmLinear linear;
  EqmEstimate estimate;
  PetscReal limit;

  PetscFunctionBegin;
  PetscCall(EqmMemoryLimit(mesh->comm, &limit));
  CHECK(limit > 1e6 && limit < INFINITY, "%g bytes are free", (double)limit);
  PetscCall(EqmLinearCreate(mesh, ordering, unknowns, EQM_MATRIX_COUPLED, &linear));
  CHECK(linear->kind != EQM_SOLVER_MULTIGRID, "the factor of a small mesh does not fit");
  estimate = linear->estimate;
  PetscCall(EqmLinearDestroy(&linear));
  CHECK(estimate.nonzeros > mesh->num_vertices && estimate.flops > estimate.nonzeros, "%g nonzeros, %g operations",
        (double)estimate.nonzeros, (double)estimate.flops);
  CHECK(estimate.bytes >= 8. * estimate.nonzeros && estimate.bytes < 1e9, "%g bytes for %g nonzeros",
        (double)estimate.bytes, (double)estimate.nonzeros);
  CHECK(estimate.most_bytes_on_rank >= estimate.bytes_on_rank && estimate.most_bytes_on_rank <= estimate.bytes,
        "%g bytes on a rank, %g in all", (double)estimate.most_bytes_on_rank, (double)estimate.bytes);
  PetscCall(TestOptionsBegin("-memory_limit 1e-6", &options));
  PetscCall(EqmLinearCreate(mesh, ordering, unknowns, EQM_MATRIX_SCALAR, &linear));
  CHECK(linear->kind == EQM_SOLVER_MULTIGRID, "%s in a thousand bytes", EqmSolverKinds[linear->kind]);
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(PetscOptionsInsertString(options, "-linear_solver mumps"));
  CHECK_FAILS(EQM_ERR_USAGE, EqmLinearCreate(mesh, ordering, unknowns, EQM_MATRIX_SCALAR, &linear));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestUnknowns(EqmMesh mesh, const EqmUnknowns *unknowns, EqmMatrixUse use)
{
  EqmOrdering ordering;

  PetscFunctionBegin;
  PetscCall(EqmOrderingCreate(mesh, &ordering));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver auto"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver substructure"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver substructure -linear_shared_front 0"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver mumps"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver multigrid"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use, "-linear_solver petsc"));
  PetscCall(TestSolver(mesh, ordering, unknowns, use,
                       "-linear_solver petsc -linear_pc_type jacobi -linear_mat_type sbaij -linear_ksp_max_it 5000"));
  for (PetscInt k = 0; k < 2; k++) {
    const char *const option = k ? "-linear_solver multifrontal" : "-linear_solver cholmod";
    if (mesh->size == 1)
      PetscCall(TestSolver(mesh, ordering, unknowns, use, option));
    else
      PetscCall(TestOnSeveralRanks(mesh, ordering, unknowns, option));
  }
  if (use != EQM_MATRIX_SCALAR && mesh->num_vertices > 100) { /* else ranks have nothing inside */
    PetscCall(TestSolver(mesh, ordering, unknowns, EQM_MATRIX_STEP, "-linear_precision single"));
    PetscCall(
        TestSolver(mesh, ordering, unknowns, EQM_MATRIX_STEP, "-linear_precision single -linear_solver substructure"));
    PetscCall(TestPrecision(mesh, ordering, unknowns));
  }
  PetscCall(TestMemory(mesh, ordering, unknowns));
  PetscCall(EqmOrderingDestroy(&ordering));
  PetscFunctionReturn(0);
}

/* Scalar unknowns, then two, one and no unknowns at a vertex. */
static PetscErrorCode TestOnMesh(const char *shape, PetscInt n, const char *partition)
{
  TestMesh test;
  EqmDomain domain;
  unsigned char *ones;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(partition, &options));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 2, &test));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(PetscMalloc1(test.mesh->num_local, &ones));
  for (PetscInt v = 0; v < test.mesh->num_local; v++) ones[v] = 1;
  const EqmUnknowns scalar = {.num_owned = test.mesh->num_owned,
                              .first = test.mesh->vertex_start,
                              .start = test.mesh->global,
                              .count = ones};
  PetscCall(TestUnknowns(test.mesh, &scalar, EQM_MATRIX_SCALAR));
  PetscCall(EqmDomainCreateSquare(test.mesh, NULL, &domain));
  const EqmUnknowns coupled = {.num_owned = domain->num_dofs,
                               .first = domain->dof_first,
                               .start = domain->dof_start,
                               .count = domain->dof_count};
  PetscCall(TestUnknowns(test.mesh, &coupled, EQM_MATRIX_COUPLED));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(PetscFree(ones));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* One rank's factor and solutions on so many threads; `x` holds 5 columns. */
static PetscErrorCode SolveOnThreads(EqmMesh mesh, const EqmUnknowns *unknowns, EqmMatrixUse use, int threads,
                                     PetscReal *x)
{
  TestMatrix model = {.mesh = mesh, .unknowns = *unknowns, .shift = .5, .spoil = 1e3};
  EqmOrdering ordering;
  EqmLinear linear;
  PetscOptions options;
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  omp_set_num_threads(threads);
  PetscCall(TestOptionsBegin("-linear_solver multifrontal -linear_precision single", &options));
  PetscCall(EqmOrderingCreate(mesh, &ordering));
  PetscCall(EqmLinearCreate(mesh, ordering, unknowns, use, &linear));
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, &model, 1., &success));
  CHECK(!success, "an indefinite matrix passes for definite on %d threads", threads);
  model.spoil = 0.;
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, &model, 1., &success));
  CHECK(success, "a definite matrix is refused on %d threads", threads);
  for (PetscInt i = 0; i < 5 * unknowns->num_owned; i++) x[i] = Entry(i, 3);
  PetscCall(EqmLinearSolve(linear, 5, x, x));
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(EqmOrderingDestroy(&ordering));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* The same bits for any number of threads, and a solution: a surface, with many branches, and a solid, with large
   fronts; in double (coupled) or single precision (steps). */
static PetscErrorCode TestThreads(const char *shape, PetscInt n, EqmMatrixUse use)
{
  TestMesh test;
  unsigned char *ones;
  PetscReal *x[2], *b;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 2, &test));
  if (test.mesh->size > 1) {
    PetscCall(TestMeshDestroy(&test));
    PetscFunctionReturn(0);
  }
  const PetscInt size = 5 * test.mesh->num_owned;
  PetscCall(PetscMalloc1(test.mesh->num_local, &ones));
  for (PetscInt v = 0; v < test.mesh->num_local; v++) ones[v] = 1;
  EqmUnknowns scalar = {.num_owned = test.mesh->num_owned, .start = test.mesh->global, .count = ones};
  PetscCall(PetscMalloc3(size, &x[0], size, &x[1], size, &b));
  PetscCall(SolveOnThreads(test.mesh, &scalar, use, 1, x[0]));
  TestMatrix model = {.mesh = test.mesh, .unknowns = scalar, .shift = .5};
  for (PetscInt i = 0; i < size; i++) b[i] = Entry(i, 3);
  for (PetscInt k = 0; k < 5; k++)
    PetscCall(CheckResidual(&model, 1., b + k * scalar.num_owned, x[0] + k * scalar.num_owned,
                            use == EQM_MATRIX_STEP ? 1e-5 : 1e-12));
  for (int threads = 2; threads <= 5; threads++) {
    PetscCall(SolveOnThreads(test.mesh, &scalar, use, threads, x[1]));
    CHECK(!memcmp(x[0], x[1], (size_t)size * sizeof(PetscReal)), "other bits on %d threads, %s", threads, shape);
  }
  omp_set_num_threads(1);
  PetscCall(PetscFree3(x[0], x[1], b));
  PetscCall(PetscFree(ones));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

/* A run inside another takes over what concerns solvers, and nothing else. */
static PetscErrorCode TestPassedOptions(void)
{
  static const char *const options[] = {"-linear_solver multigrid -max_it 7 -multigrid_ksp_view", "-memory_limit 1e-3"};
  PetscOptions outer, inner;
  PetscReal limit = 0.;
  PetscBool found[4];
  char solver[32] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsCreate(&inner));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(options); k++) {
    PetscCall(PetscOptionsCreate(&outer));
    PetscCall(PetscOptionsInsertString(outer, options[k]));
    PetscCall(PetscOptionsPush(outer));
    PetscCall(EqmLinearPassOptions(inner));
    PetscCall(PetscOptionsPop());
    PetscCall(PetscOptionsDestroy(&outer));
  }
  PetscCall(PetscOptionsGetString(inner, NULL, "-linear_solver", solver, sizeof(solver), &found[0]));
  PetscCall(PetscOptionsHasName(inner, NULL, "-max_it", &found[1]));
  PetscCall(PetscOptionsHasName(inner, NULL, "-multigrid_ksp_view", &found[2]));
  PetscCall(PetscOptionsGetReal(inner, NULL, "-memory_limit", &limit, &found[3]));
  CHECK(found[0] && !strcmp(solver, "multigrid"), "the solver is '%s'", solver);
  CHECK(!found[1] && found[2] && found[3] && limit == 1e-3, "not these options: limit %g", (double)limit);
  PetscCall(PetscOptionsDestroy(&inner));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestPassedOptions());
  PetscCall(TestOnMesh("hills", 900, "-partition metis"));
  PetscCall(TestOnMesh("hills", 300, "-partition slab")); /* shares of many pieces */
  PetscCall(TestOnMesh("hills", 16, "-partition slab"));  /* ranks with nothing inside */
  PetscCall(TestThreads("hills", 12000, EQM_MATRIX_COUPLED));
  PetscCall(TestThreads("hills", 12000, EQM_MATRIX_STEP));
  PetscCall(TestThreads("ball", 9000, EQM_MATRIX_COUPLED));
  PetscCall(TestThreads("ball", 9000, EQM_MATRIX_STEP));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
