/* Conjugate gradients with smoothed aggregation, where a factor would not fit. */
#include "linalg/linalg.h"
#include <petscksp.h>

typedef struct {
  KSP ksp;
  Vec b, x;
} Multigrid;

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Multigrid *const g = linear->data;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatCreateVecs(matrix, &g->x, &g->b));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Multigrid *const g = linear->data;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  PetscCall(KSPSetOperators(g->ksp, matrix, matrix));
  PetscCall(KSPSetUp(g->ksp));
  *success = PETSC_TRUE;
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x)
{
  Multigrid *const g = linear->data;
  KSPConvergedReason reason;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num_rhs; k++) {
    PetscScalar *array;
    PetscCall(VecGetArrayWrite(g->b, &array));
    PetscCall(PetscArraycpy(array, b + k * linear->num_owned, linear->num_owned));
    PetscCall(VecRestoreArrayWrite(g->b, &array));
    PetscCall(KSPSolve(g->ksp, g->b, g->x));
    PetscCall(KSPGetConvergedReason(g->ksp, &reason));
    PetscCheck(reason > 0, linear->mesh->comm, PETSC_ERR_NOT_CONVERGED,
               "multigrid did not converge: %s; try -linear_solver mumps", KSPConvergedReasons[reason]);
    PetscCall(VecGetArray(g->x, &array));
    PetscCall(PetscArraycpy(x + k * linear->num_owned, array, linear->num_owned));
    PetscCall(VecRestoreArray(g->x, &array));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Multigrid *const g = linear->data;

  PetscFunctionBegin;
  PetscCall(KSPDestroy(&g->ksp));
  PetscCall(VecDestroy(&g->b));
  PetscCall(VecDestroy(&g->x));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* Make `linear` a multigrid-preconditioned iteration; options with the prefix -multigrid_. Collective. */
PetscErrorCode EqmLinearSetUpMultigrid(EqmLinear linear)
{
  Multigrid *g;
  PC pc;

  PetscFunctionBegin;
  PetscCall(PetscNew(&g));
  linear->data = g;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  PetscCall(KSPCreate(linear->mesh->comm, &g->ksp));
  PetscCall(KSPSetType(g->ksp, KSPCG));
  PetscCall(KSPSetNormType(g->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(g->ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
  PetscCall(KSPGetPC(g->ksp, &pc));
  PetscCall(PCSetType(pc, PCGAMG));
  PetscCall(KSPSetOptionsPrefix(g->ksp, "multigrid_"));
  PetscCall(KSPSetFromOptions(g->ksp));
  PetscFunctionReturn(0);
}
