/* Dense fronts between ranks: dealt to several ranks they give what they give on one, the same bits every time, and
   see that a matrix is not definite. */
#include "support/testing.h"
#include "support/cellmatrix.h"
#include "linalg/interface_private.h"
#include <string.h>

enum { NUM_RHS = 3 };

/* Factor with fronts of more than `largest` unknowns shared, and solve. */
static PetscErrorCode Solve(TestMatrix *model, EqmOrdering ordering, PetscInt largest, EqmEstimate *estimate,
                            PetscReal *x)
{
  const PetscInt n = model->unknowns.num_owned;
  char option[80];
  PetscBool success;
  PetscOptions options;
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-linear_solver substructure -linear_shared_front %d", (int)largest));
  PetscCall(TestOptionsBegin(option, &options));
  PetscCall(EqmLinearCreate(model->mesh, ordering, &model->unknowns, EQM_MATRIX_COUPLED, &linear));
  *estimate = linear->estimate;
  PetscCall(EqmLinearFactor(linear, TestCellMatrix, model, 1., &success));
  CHECK(success == (model->spoiled < 0), "fronts beyond %d shared: the matrix is said to be %sdefinite", (int)largest,
        success ? "" : "in");
  if (success) {
    for (PetscInt i = 0; i < NUM_RHS * n; i++) x[i] = TestRandom(5, model->unknowns.first + i % n, i / n);
    PetscCall(EqmLinearSolve(linear, NUM_RHS, x, x));
  }
  PetscCall(EqmLinearDestroy(&linear));
  PetscCall(TestOptionsEnd(&options));
  PetscFunctionReturn(0);
}

/* Largest number of a list, and largest difference of two, over all ranks. */
static PetscErrorCode CheckAlike(PetscInt count, const PetscReal *x, const PetscReal *y, PetscInt largest)
{
  PetscReal local[2] = {0., 0.}, global[2];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < count; i++) {
    local[0] = PetscMax(local[0], PetscAbsReal(x[i] - y[i]));
    local[1] = PetscMax(local[1], PetscAbsReal(x[i]));
  }
  PetscCall(MPIU_Allreduce(local, global, 2, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  CHECK(global[0] <= 1e-12 * global[1], "fronts beyond %d shared: solutions differ by %g of %g", (int)largest,
        (double)global[0], (double)global[1]);
  PetscFunctionReturn(0);
}

static PetscErrorCode TestShared(TestMatrix *model, EqmOrdering ordering)
{
  const PetscInt n = NUM_RHS * model->unknowns.num_owned;
  const PetscBool can = (PetscBool)(model->mesh->size > 1 && EqmInterfaceCanShare());
  EqmEstimate alone, shared;
  const EqmSeparation *separation;
  PetscReal *x, *y, *again;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &x, n, &y, n, &again));
  PetscCall(Solve(model, ordering, 1000000, &alone, x));
  CHECK(alone.front_ranks == 1 && alone.largest_front_on_one == alone.largest_front, "a front is shared by %d ranks",
        (int)alone.front_ranks);
  for (PetscInt largest = 0; largest <= alone.largest_front; largest += PetscMax(1, alone.largest_front / 3)) {
    PetscCall(Solve(model, ordering, largest, &shared, y));
    PetscCall(CheckAlike(n, x, y, largest));
    CHECK(!can || largest >= alone.largest_front || shared.front_ranks > 1, "no front beyond %d is shared",
          (int)largest);
    CHECK(shared.largest_front == alone.largest_front, "the largest front has %d unknowns", (int)shared.largest_front);
    PetscCall(Solve(model, ordering, largest, &shared, again));
    CHECK(!memcmp(y, again, (size_t)n * sizeof(PetscReal)), "fronts beyond %d shared: other bits", (int)largest);
  }
  PetscCall(EqmOrderingGetSeparation(ordering, &separation));
  if (separation->num_separators) model->spoiled = model->unknowns.start[separation->vertex[0]];
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &model->spoiled, 1, MPIU_INT, MPI_MAX, PETSC_COMM_WORLD));
  PetscCall(Solve(model, ordering, 1000000, &shared, y));
  PetscCall(Solve(model, ordering, 0, &shared, y));
  model->spoiled = -1;
  PetscCall(PetscFree3(x, y, again));
  PetscFunctionReturn(0);
}

static PetscErrorCode TestOnMesh(const char *shape, PetscInt n, const char *partition)
{
  TestMesh test;
  EqmDomain domain;
  EqmOrdering ordering;
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(TestOptionsBegin(partition, &options));
  PetscCall(TestMeshCreate(PETSC_COMM_WORLD, shape, n, 2, &test));
  PetscCall(TestOptionsEnd(&options));
  PetscCall(EqmOrderingCreate(test.mesh, &ordering));
  PetscCall(EqmDomainCreateSquare(test.mesh, NULL, &domain));
  TestMatrix model = {.mesh = test.mesh,
                      .unknowns = {.num_owned = domain->num_dofs,
                                   .first = domain->dof_first,
                                   .start = domain->dof_start,
                                   .count = domain->dof_count},
                      .shift = .3,
                      .spoil = 1e3,
                      .spoiled = -1};
  PetscCall(TestShared(&model, ordering));
  PetscCall(EqmDomainDestroy(&domain));
  PetscCall(EqmOrderingDestroy(&ordering));
  PetscCall(TestMeshDestroy(&test));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  PetscCall(TestOnMesh("hills", 3000, "-partition metis"));
  PetscCall(TestOnMesh("hills", 400, "-partition slab")); /* nearly all is between the ranks */
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
