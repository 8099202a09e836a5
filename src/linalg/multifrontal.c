/* The multifrontal factor as a linear solver: one rank, any number of threads. */
#include "linalg/frontal.h"
#include "mesh/mesh_private.h"

/* Has it the memory for what it did last? */
static PetscErrorCode Check(EqmFrontal frontal, const char *what)
{
  PetscFunctionBegin;
  PetscCheck(EqmFrontalHasMemory(frontal), PETSC_COMM_SELF, PETSC_ERR_MEM,
             "too little memory for the %s of a matrix on one rank; use more ranks, or -linear_solver multigrid", what);
  PetscFunctionReturn(0);
}

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  EqmFrontal frontal;
  cholmod_sparse view;
  PetscInt *order;

  PetscFunctionBegin;
  PetscCall(EqmOrderingOfFactor(linear, ordering, &order));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(EqmCholmodGetView(linear, &view));
  PetscCall(EqmFrontalCreate(&view, order, &frontal));
  linear->data = frontal;
  if (linear->is_single) PetscCall(EqmFrontalKeepSingle(frontal));
  PetscCall(EqmCholmodRestoreView(linear, &view));
  PetscCall(PetscFree(order));
  PetscCall(Check(frontal, "analysis"));
  PetscCall(EqmFrontalGetCost(frontal, &linear->estimate));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  const EqmFrontal frontal = linear->data;
  cholmod_sparse view;

  PetscFunctionBegin;
  PetscCall(EqmCholmodGetView(linear, &view));
  PetscCall(EqmFrontalFactor(frontal, view.x, success));
  PetscCall(Check(frontal, "factorisation"));
  PetscCall(EqmCholmodRestoreView(linear, &view));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  PetscFunctionBegin;
  PetscCall(EqmFrontalSolve(linear->data, EQM_SOLVE_BOTH, num_rhs, b, x));
  PetscCall(Check(linear->data, "solutions"));
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  EqmFrontal frontal = linear->data;

  PetscFunctionBegin;
  PetscCall(EqmFrontalDestroy(&frontal));
  linear->data = NULL;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearSetUpMultifrontal(EqmLinear linear)
{
  PetscFunctionBegin;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  PetscFunctionReturn(0);
}
