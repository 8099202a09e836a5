/* Multigrid on levels that all ranks share: it solves the system that it was given, and as fast, with the same
   solution, on any number of ranks and threads. */
#include "support/testing.h"
#include "base/rows.h"
#include "hierarchy/balance.h"
#include "hierarchy/sharedcascade.h"
#include "hierarchy/sharedcycle.h"
#include "mesh/mesh_private.h"
#include <omp.h>

typedef struct {
  TestMesh mesh;
  EqmDomain domain;
  EqmPlace place;
  EqmShared levels;
  EqmLevelMap map;
  EqmLevelSystem system;
  EqmSharedCycle cycle;
} Case;

/* A map that sweeps alone have made, so that it is the same on any number of ranks; its Gauss-Newton matrix. */
static PetscErrorCode CaseCreate(MPI_Comm comm, const char *shape, EqmCascadeTarget target, Case *test)
{
  EqmHierarchyOptions options;
  EqmCascadeOptions cascade;
  EqmCascadeResult result;
  EqmLevelValue value;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(TestMeshCreate(comm, shape, 3000, 1, &test->mesh));
  if (target == EQM_TARGET_DISK)
    PetscCall(EqmDomainCreateDisk(test->mesh.mesh, &test->domain));
  else
    PetscCall(EqmDomainCreateSphere(test->mesh.mesh, &test->domain));
  PetscCall(EqmPlaceCreate(test->domain, &test->place));
  PetscCall(EqmDomainPlaceBoundary(test->domain, &test->place));
  PetscCall(EqmHierarchyOptionsDefault(&options));
  options.gathered = options.vertices_of_piece = 400;
  PetscCall(EqmSharedCreate(test->mesh.mesh, &options, &test->levels));
  PetscCall(EqmCascadeOptionsDefault(&cascade));
  cascade.steps = 0;
  PetscCall(EqmSharedCascade(test->levels, target, &cascade, test->place.x, &result));
  PetscCall(EqmSharedMapCreate(&test->levels->level[0], target, test->place.x, &test->map));
  test->map.epsilon = .01;
  PetscCall(EqmSharedEvaluate(&test->levels->level[0], &test->map, test->map.x, &value));
  PetscCall(EqmBalanceSystemCreate(&test->map, &test->system));
  PetscCall(EqmBalanceAssemble(&test->map, .03, value.residual, &test->system, &success));
  CHECK(success && value.folds == 0, "no matrix of %s", shape);
  PetscCall(EqmSharedCycleCreate(test->levels, 0, target, &test->map, 100, &test->system, &test->cycle));
  PetscCall(EqmSharedCycleFill(test->cycle, &success));
  CHECK(success, "a matrix of %s is not definite", shape);
  PetscFunctionReturn(0);
}

static PetscErrorCode CaseDestroy(Case *test)
{
  PetscFunctionBegin;
  PetscCall(EqmSharedCycleDestroy(&test->cycle));
  PetscCall(EqmLevelSystemDestroy(&test->system));
  PetscCall(EqmLevelMapDestroy(&test->map));
  PetscCall(EqmSharedDestroy(&test->levels));
  PetscCall(EqmPlaceDestroy(&test->place));
  PetscCall(EqmDomainDestroy(&test->domain));
  PetscCall(TestMeshDestroy(&test->mesh));
  PetscFunctionReturn(0);
}

/* What is left of the right-hand side, by the system's own rows, whose columns have the ghosts' values. */
static PetscErrorCode CheckResidual(const Case *test, const char *shape)
{
  const PetscInt n = test->levels->level[0].num_owned;
  EqmBlockMatrix rows = test->system.matrix;
  PetscReal *product, squared = 0., before = 0.;

  PetscFunctionBegin;
  rows.num_rows = n;
  PetscCall(PetscMalloc1(2 * n, &product));
  EqmBlockMatrixMultiply(&rows, test->system.solution, product);
  for (PetscInt k = 0; k < 2 * n; k++) {
    squared += PetscSqr(test->system.right[k] - product[k]);
    before += PetscSqr(test->system.right[k]);
  }
  squared = TestSum(PETSC_COMM_WORLD, squared);
  before = TestSum(PETSC_COMM_WORLD, before);
  CHECK(before > 0. && squared < 1e-12 * before, "%s: residual %g of %g", shape, (double)PetscSqrtReal(squared),
        (double)PetscSqrtReal(before));
  PetscCall(PetscFree(product));
  PetscFunctionReturn(0);
}

/* Of this rank's part of the input's vertices. */
static PetscErrorCode SolutionOfInput(Case *test, PetscReal *input)
{
  const EqmMesh mesh = test->mesh.mesh;
  PetscReal *owned;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * mesh->num_local, &owned));
  PetscCall(EqmRowsToRoots(test->levels->level[0].from_finer, 2, test->system.solution, owned));
  PetscCall(EqmMeshVerticesToInput(mesh, test->mesh.soup, 2, owned, input));
  PetscCall(PetscFree(owned));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestSolution(const char *shape, EqmCascadeTarget target)
{
  Case all, alone;
  PetscInt iterations[2] = {0, 0};
  PetscReal *ours, *theirs, largest = 0.;
  PetscBool success[2];
  EqmSoup soup;

  PetscFunctionBegin;
  PetscCall(CaseCreate(PETSC_COMM_WORLD, shape, target, &all));
  PetscCall(EqmSharedCycleSolve(all.cycle, 1e-9, &iterations[0], &success[0]));
  PetscCall(CheckResidual(&all, shape));
  omp_set_num_threads(3);
  PetscCall(CaseCreate(PETSC_COMM_SELF, shape, target, &alone));
  PetscCall(EqmSharedCycleSolve(alone.cycle, 1e-9, &iterations[1], &success[1]));
  omp_set_num_threads(1);
  CHECK(all.levels->num_levels > 2, "%d levels of %s", (int)all.levels->num_levels, shape);
  CHECK(success[0] && success[1] && iterations[0] < 60 && PetscAbsInt(iterations[0] - iterations[1]) < 3,
        "%s: %d and %d iterations", shape, (int)iterations[0], (int)iterations[1]);
  soup = all.mesh.soup;
  PetscCall(PetscCalloc2(2 * soup->num_vertices, &ours, 2 * soup->num_vertices, &theirs));
  PetscCall(SolutionOfInput(&all, ours));
  PetscCall(SolutionOfInput(&alone, theirs));
  for (PetscInt k = 0; k < 2 * soup->num_vertices; k++) largest = PetscMax(largest, PetscAbsReal(theirs[k]));
  for (PetscInt k = 0; k < 2 * (soup->vertex_end - soup->vertex_start); k++)
    CHECK_CLOSE(ours[k], theirs[k + 2 * soup->vertex_start], all.mesh.mesh->size == 1 ? 0. : 1e-5, largest);
  PetscCall(PetscFree2(ours, theirs));
  PetscCall(CaseDestroy(&alone));
  PetscCall(CaseDestroy(&all));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestSolution("hills", EQM_TARGET_DISK));
  PetscCall(TestSolution("head", EQM_TARGET_SPHERE));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
