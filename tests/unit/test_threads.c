/* The same bits for 1, 2 and 4 threads: energy, gradient, Laplacian, assembled matrix. */
#include "support/testing.h"
#include "domain/domain_private.h"
#include <omp.h>
#include <string.h>

/* What is compared. */
typedef struct {
  PetscReal energy, dirichlet;
  EqmImageTotals totals;
  PetscReal *applied; /* 2 per owned vertex */
  Vec gradient;
  Mat matrix;
} Results;

/* Something smooth of the vertices' numbers, so that every entry counts. */
static void CellMatrix(void *context, PetscInt cell, PetscReal *matrix)
{
  const EqmDomain domain = context;
  PetscReal q[6];
  PetscInt n = 0;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscInt v = domain->mesh->cells[3 * cell + a];
    for (PetscInt k = 0; k < domain->dof_count[v]; k++) q[n++] = PetscSinReal(domain->dof_start[v] + k);
  }
  for (PetscInt k = 0; k < n * n; k++) matrix[k] = q[k / n] * q[k % n] / 3.;
}

static PetscErrorCode Compute(EqmDomain domain, const EqmPlace *place, int threads, Results *r)
{
  const EqmMesh mesh = domain->mesh;
  const EqmUnknowns unknowns = {.num_owned = domain->num_dofs,
                                .first = domain->dof_first,
                                .start = domain->dof_start,
                                .count = domain->dof_count};
  PetscReal *a, *weights;
  EqmAssembly assembly;
  Mat matrix;

  PetscFunctionBegin;
  omp_set_num_threads(threads);
  *r = (Results){0};
  PetscCall(PetscMalloc1(2 * mesh->num_owned, &r->applied));
  PetscCall(PetscMalloc2(mesh->num_local_cells, &a, 3 * mesh->num_local_cells, &weights));
  PetscCall(EqmDomainCreateVec(domain, &r->gradient));
  PetscCall(EqmAuthalicEnergy(domain, place, a, &r->energy, r->gradient));
  PetscCall(EqmImageSum(mesh, a, &r->totals));
  PetscCall(EqmLaplacianWeights(domain, EQM_LAPLACIAN_STRETCH, place, weights));
  PetscCall(EqmLaplacianApply(mesh, weights, 2, place->x, r->applied));
  PetscCall(EqmLaplacianEnergy(mesh, weights, 2, place->x, &r->dirichlet));
  PetscCall(EqmAssemblyCreate(mesh, &unknowns, EQM_STORE_FULL, &assembly));
  PetscCall(EqmAssemblyFill(assembly, CellMatrix, domain));
  PetscCall(EqmAssemblyGetMat(assembly, &matrix));
  PetscCall(MatDuplicate(matrix, MAT_COPY_VALUES, &r->matrix));
  PetscCall(EqmAssemblyDestroy(&assembly));
  PetscCall(PetscFree2(a, weights));
  PetscFunctionReturn(0);
}

static PetscErrorCode Compare(EqmMesh mesh, const Results *one, const Results *many, int threads)
{
  PetscBool same;

  PetscFunctionBegin;
  CHECK(one->energy == many->energy && one->dirichlet == many->dirichlet, "%d threads: energy off by %g, %g", threads,
        (double)(many->energy - one->energy), (double)(many->dirichlet - one->dirichlet));
  CHECK(one->totals.total == many->totals.total && one->totals.energy == many->totals.energy &&
            one->totals.sd == many->totals.sd && one->totals.smallest == many->totals.smallest &&
            one->totals.folds == many->totals.folds,
        "%d threads: other totals", threads);
  CHECK(!memcmp(one->applied, many->applied, sizeof(PetscReal) * 2 * (size_t)mesh->num_owned),
        "%d threads: L x differs", threads);
  PetscCall(VecEqual(one->gradient, many->gradient, &same));
  CHECK(same, "%d threads: the gradient differs", threads);
  PetscCall(MatEqual(one->matrix, many->matrix, &same));
  CHECK(same, "%d threads: the matrix differs", threads);
  PetscFunctionReturn(0);
}

static PetscErrorCode Reset(Results *r)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(r->applied));
  PetscCall(VecDestroy(&r->gradient));
  PetscCall(MatDestroy(&r->matrix));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  TestMesh test;
  EqmSolver solver;
  Results one, many;

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  omp_set_dynamic(0);
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, "hills", 5000, 1, &test));
  CHECK(test.mesh->num_blocks > 4, "%d blocks are too few to show anything", (int)test.mesh->num_blocks);
  PetscCall(TestStart(test.mesh, "disk", &solver));
  PetscCall(Compute(solver->problem->domain, &solver->iterate->place, 1, &one));
  for (int threads = 2; threads <= 4; threads += 2) {
    PetscCall(Compute(solver->problem->domain, &solver->iterate->place, threads, &many));
    PetscCall(Compare(test.mesh, &one, &many, threads));
    PetscCall(Reset(&many));
  }
  PetscCall(Reset(&one));
  PetscCall(EqmSolverDestroy(&solver));
  PetscCall(TestMeshDestroy(&test));
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
