/* Multigrid's cycle in single precision: symmetric, definite and as good as PETSc's in double with the same sweeps,
   though it sweeps in pieces; to the bit the same for any number of threads; as good on any number of ranks; on
   aggregates that are not smoothed, where it stretches corrections, better. */
#include "support/testing.h"
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "linalg/linalg.h"
#include "linalg/singlecycle.h"
#include "mesh/mesh_private.h"
#include <omp.h>

typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmPlace place;
  PetscReal *weights;
  PetscInt *start;
  unsigned char *count;
  EqmAssembly assembly;
  Mat matrix;
  KSP ksp; /* with PETSc's aggregation */
  EqmSingleCycle cycle;
  PetscReal scale;
  Vec b, x;
} Case;

/* Stiff against compression, as the metric of solids is; and a little mass, without frames that hold the boundary. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const Case *const c = context;
  const EqmMesh mesh = c->mesh.mesh;
  const PetscInt *const v = mesh->cells + 4 * cell;
  const PetscReal *const x = c->place.x, *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
  PetscReal gradient[12], laplacian[4][4];

  EqmVolumeGradient(p, gradient);
  EqmCellLaplacian(4, c->weights + 6 * cell, laplacian);
  for (PetscInt i = 0; i < 12; i++) {
    for (PetscInt j = 0; j < 12; j++) {
      matrix[12 * i + j] = c->scale * gradient[i] * gradient[j] / mesh->weight[cell];
      if (i % 3 == j % 3) matrix[12 * i + j] += c->scale * .01 * laplacian[i / 3][j / 3];
      if (i == j) matrix[12 * i + j] += c->scale * .02 * mesh->weight[cell];
    }
  }
}

static PetscErrorCode Assemble(Case *c, PetscReal scale)
{
  PetscFunctionBegin;
  c->scale = scale;
  PetscCall(EqmAssemblyFill(c->assembly, CellMatrix, c));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakeMatrix(Case *c)
{
  const EqmMesh mesh = c->mesh.mesh;
  EqmUnknowns unknowns = {.num_owned = 3 * mesh->num_owned, .first = 3 * mesh->vertex_start};
  MatNullSpace near;
  Vec fields[3];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(mesh->num_local, &c->start, mesh->num_local, &c->count));
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    c->start[v] = 3 * mesh->global[v];
    c->count[v] = 3;
  }
  unknowns.start = c->start;
  unknowns.count = c->count;
  PetscCall(EqmAssemblyCreate(mesh, &unknowns, EQM_STORE_FULL, &c->assembly));
  PetscCall(EqmAssemblyGetMat(c->assembly, &c->matrix));
  PetscCall(MatSetBlockSize(c->matrix, 3));
  PetscCall(Assemble(c, 1.));
  PetscCall(MatCreateVecs(c->matrix, &c->x, &c->b));
  for (PetscInt k = 0; k < 3; k++) {
    PetscScalar *array;
    PetscCall(VecDuplicate(c->b, &fields[k]));
    PetscCall(VecGetArray(fields[k], &array));
    for (PetscInt v = 0; v < mesh->num_owned; v++) array[3 * v + k] = 1.;
    PetscCall(VecRestoreArray(fields[k], &array));
    PetscCall(VecNormalize(fields[k], NULL));
  }
  PetscCall(MatNullSpaceCreate(mesh->comm, PETSC_FALSE, 3, fields, &near));
  PetscCall(MatSetNearNullSpace(c->matrix, near));
  PetscCall(MatNullSpaceDestroy(&near));
  for (PetscInt k = 0; k < 3; k++) PetscCall(VecDestroy(&fields[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseCreate(MPI_Comm comm, PetscInt n, PetscBool smoothed, Case *c)
{
  static const char *const settings[][2] = {{"-test_mg_levels_ksp_type", "richardson"},
                                            {"-test_mg_levels_ksp_max_it", "1"},
                                            {"-test_mg_levels_pc_type", "sor"},
                                            {"-test_pc_gamg_agg_nsmooths", "0"}};
  PetscOptions options;
  PC pc;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(comm, "ball", n, 1, &c->mesh));
  PetscCall(EqmDomainCreate(c->mesh.mesh, "ball", NULL, &c->domain));
  PetscCall(EqmPlaceCreate(c->domain, &c->place));
  PetscCall(TestShakenBall(c->domain, 5, .002, &c->place));
  PetscCall(PetscMalloc1(6 * c->mesh.mesh->num_local_cells, &c->weights));
  PetscCall(EqmLaplacianWeights(c->domain, EQM_LAPLACIAN_STRETCH, &c->place, c->weights));
  PetscCall(MakeMatrix(c));
  PetscCall(KSPCreate(comm, &c->ksp));
  PetscCall(KSPSetType(c->ksp, KSPCG));
  PetscCall(KSPSetTolerances(c->ksp, 1e-5, PETSC_DEFAULT, PETSC_DEFAULT, 400));
  PetscCall(KSPSetOptionsPrefix(c->ksp, "test_"));
  PetscCall(KSPSetComputeEigenvalues(c->ksp, PETSC_TRUE));
  PetscCall(KSPSetOperators(c->ksp, c->matrix, c->matrix));
  PetscCall(KSPGetPC(c->ksp, &pc));
  PetscCall(PCSetType(pc, PCGAMG));
  PetscCall(PCGAMGSetReuseInterpolation(pc, PETSC_TRUE));
  PetscCall(EqmOptionsPushDefaults(settings, smoothed ? 3 : 4, &options));
  PetscCall(KSPSetFromOptions(c->ksp));
  PetscCall(KSPSetUp(c->ksp));
  PetscCall(EqmOptionsPopDefaults(&options));
  PetscCall(EqmSingleCycleRenew(pc, &c->cycle));
  CHECK(c->cycle, "no cycle of blocks of three");
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseDestroy(Case *c)
{
  PetscFunctionBegin;
  PetscCall(EqmSingleCycleDestroy(&c->cycle));
  PetscCall(KSPDestroy(&c->ksp));
  PetscCall(VecDestroy(&c->b));
  PetscCall(VecDestroy(&c->x));
  PetscCall(EqmAssemblyDestroy(&c->assembly));
  PetscCall(PetscFree2(c->start, c->count));
  PetscCall(PetscFree(c->weights));
  PetscCall(EqmPlaceDestroy(&c->place));
  PetscCall(EqmDomainDestroy(&c->domain));
  PetscCall(TestMeshDestroy(&c->mesh));
  PetscFunctionReturn(0);
}

/* Numbers of the input's vertices, the same on any number of ranks. */
static PetscErrorCode Fill(const Case *c, PetscInt seed, Vec v)
{
  PetscScalar *array;

  PetscFunctionBegin;
  PetscCall(VecGetArray(v, &array));
  for (PetscInt i = 0; i < 3 * c->mesh.mesh->num_owned; i++)
    array[i] = TestRandom(seed, c->mesh.mesh->vertex_input[i / 3], i % 3);
  PetscCall(VecRestoreArray(v, &array));
  PetscFunctionReturn(0);
}

static PetscErrorCode ApplyCycle(PC pc, Vec b, Vec x)
{
  EqmSingleCycle cycle;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &cycle));
  PetscCall(EqmSingleCycleApply(cycle, b, x));
  PetscFunctionReturn(0);
}

/* Conjugate gradients: how many iterations, and the largest eigenvalue of B A that they have seen. */
static PetscErrorCode Iterate(const Case *c, PetscBool single, PetscInt *iterations, PetscReal *largest)
{
  KSPConvergedReason reason;
  PetscReal smallest;
  PC own, pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(c->ksp, &pc));
  PetscCall(PetscObjectReference((PetscObject)pc));
  if (single) {
    PetscCall(PCCreate(c->mesh.mesh->comm, &own));
    PetscCall(PCSetType(own, PCSHELL));
    PetscCall(PCShellSetContext(own, c->cycle));
    PetscCall(PCShellSetApply(own, ApplyCycle));
    PetscCall(KSPSetPC(c->ksp, own));
    PetscCall(PCDestroy(&own));
    PetscCall(KSPSetOperators(c->ksp, c->matrix, c->matrix));
  }
  PetscCall(Fill(c, 1, c->b));
  PetscCall(KSPSolve(c->ksp, c->b, c->x));
  PetscCall(KSPGetConvergedReason(c->ksp, &reason));
  CHECK(reason > 0, "no convergence: %s", KSPConvergedReasons[reason]);
  PetscCall(KSPGetIterationNumber(c->ksp, iterations));
  PetscCall(KSPComputeExtremeSingularValues(c->ksp, largest, &smallest));
  CHECK(smallest > 0., "an eigenvalue of %g", (double)smallest);
  PetscCall(KSPSetPC(c->ksp, pc));
  PetscCall(PCDestroy(&pc));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckSymmetry(const Case *c)
{
  PetscReal there, back, size_b, size_x;
  Vec a, y;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(c->b, &a));
  PetscCall(VecDuplicate(c->b, &y));
  PetscCall(Fill(c, 2, a));
  PetscCall(Fill(c, 3, c->b));
  PetscCall(EqmSingleCycleApply(c->cycle, c->b, c->x));
  PetscCall(EqmSingleCycleApply(c->cycle, a, y));
  PetscCall(VecDot(a, c->x, &there));
  PetscCall(VecDot(y, c->b, &back));
  PetscCall(VecDot(c->b, c->x, &size_b));
  PetscCall(VecDot(a, y, &size_x));
  CHECK_CLOSE(there, back, 1e-5, PetscSqrtReal(size_b * size_x));
  PetscCall(VecDestroy(&a));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(0);
}

static PetscErrorCode CheckThreads(const Case *c)
{
  const int threads = omp_get_max_threads();
  PetscBool equal;
  Vec y;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(c->b, &y));
  PetscCall(Fill(c, 4, c->b));
  PetscCall(EqmSingleCycleApply(c->cycle, c->b, c->x));
  omp_set_num_threads(3);
  PetscCall(EqmSingleCycleApply(c->cycle, c->b, y));
  omp_set_num_threads(threads);
  PetscCall(VecEqual(c->x, y, &equal));
  CHECK(equal, "three threads make another cycle");
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(0);
}

/* Half the matrix on all levels gives twice the cycle; what is no number in single precision is refused. */
static PetscErrorCode CheckRefill(Case *c)
{
  PetscReal difference, norm;
  Vec y;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(c->ksp, &pc));
  PetscCall(VecDuplicate(c->b, &y));
  PetscCall(Fill(c, 5, c->b));
  PetscCall(EqmSingleCycleApply(c->cycle, c->b, c->x));
  PetscCall(Assemble(c, .5));
  PetscCall(KSPSetOperators(c->ksp, c->matrix, c->matrix));
  PetscCall(KSPSetUp(c->ksp));
  PetscCall(EqmSingleCycleRenew(pc, &c->cycle));
  CHECK(c->cycle, "single precision does not reach");
  PetscCall(EqmSingleCycleApply(c->cycle, c->b, y));
  PetscCall(VecNorm(y, NORM_2, &norm));
  PetscCall(VecAXPY(y, -2., c->x));
  PetscCall(VecNorm(y, NORM_2, &difference));
  CHECK(difference < 1e-5 * norm, "%g of the old cycle is left", (double)(difference / norm));
  PetscCall(Assemble(c, 1e45));
  PetscCall(KSPSetOperators(c->ksp, c->matrix, c->matrix));
  PetscCall(KSPSetUp(c->ksp));
  PetscCall(EqmSingleCycleRenew(pc, &c->cycle));
  CHECK(!c->cycle, "1e45 is a number of single precision");
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(0);
}

/* On one rank: on three PETSc's sweeps, which do not know of each other, are not definite here. */
static PetscErrorCode CompareWithPetsc(const Case *c, PetscInt iterations)
{
  PetscInt with_petsc;
  PetscReal unused;

  PetscFunctionBegin;
  PetscCall(Iterate(c, PETSC_FALSE, &with_petsc, &unused));
  CHECK(iterations <= with_petsc + with_petsc / 8 + 1, "%d iterations with the cycle, %d with PETSc's", (int)iterations,
        (int)with_petsc);
  PetscFunctionReturn(0);
}

/* The same on one rank. */
static PetscErrorCode CompareWithOneRank(PetscInt num_vertices, PetscInt iterations)
{
  PetscInt iterations_alone;
  PetscReal unused;
  Case alone = {.cycle = NULL};

  PetscFunctionBegin;
  PetscCall(CaseCreate(PETSC_COMM_SELF, num_vertices, PETSC_TRUE, &alone));
  PetscCall(Iterate(&alone, PETSC_TRUE, &iterations_alone, &unused));
  CHECK(PetscAbsInt(iterations - iterations_alone) <= 1 + iterations_alone / 8, "%d iterations, %d on one rank",
        (int)iterations, (int)iterations_alone);
  PetscCall(CaseDestroy(&alone));
  PetscFunctionReturn(0);
}

/* Without smoothing corrections are stretched: fewer iterations than with PETSc's cycle, which takes them as they are.
 */
static PetscErrorCode CheckStretch(PetscInt num_vertices)
{
  PetscInt iterations, with_petsc;
  PetscReal unused;
  Case plain = {.cycle = NULL};

  PetscFunctionBegin;
  PetscCall(CaseCreate(PETSC_COMM_SELF, num_vertices, PETSC_FALSE, &plain));
  PetscCall(Iterate(&plain, PETSC_TRUE, &iterations, &unused));
  PetscCall(Iterate(&plain, PETSC_FALSE, &with_petsc, &unused));
  CHECK(iterations < with_petsc, "%d iterations with the cycle, %d with PETSc's", (int)iterations, (int)with_petsc);
  PetscCall(CheckSymmetry(&plain));
  PetscCall(CaseDestroy(&plain));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  enum { VERTICES = 18000 }; /* pieces meet in threes */
  PetscReal largest;
  PetscInt iterations;
  Case test = {.cycle = NULL};

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(CaseCreate(PETSC_COMM_WORLD, VERTICES, PETSC_TRUE, &test));
  PetscCall(Iterate(&test, PETSC_TRUE, &iterations, &largest));
  CHECK(largest < 1. + 1e-3, "the cycle overshoots: an eigenvalue of %g", (double)largest);
  if (test.mesh.mesh->size == 1) {
    PetscCall(CompareWithPetsc(&test, iterations));
    PetscCall(CheckStretch(VERTICES));
  } else {
    PetscCall(CompareWithOneRank(VERTICES, iterations));
  }
  PetscCall(CheckSymmetry(&test));
  PetscCall(CheckThreads(&test));
  PetscCall(CheckRefill(&test));
  PetscCall(CaseDestroy(&test));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
