/* PETSc's own solvers, by options: -linear_solver petsc with -linear_ksp_type, -linear_pc_type, -linear_mat_type,
   -linear_vec_type and all that belongs to these. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include <petscksp.h>

typedef struct {
  KSP ksp;
  Mat matrix; /* of the type in the options: the assembled matrix or a copy */
  Vec b, x;
} Petsc;

static const char *const prefix = "linear_";

/* Unless options say otherwise: conjugate gradients, which find that a matrix is not definite, with a Cholesky factor
   as preconditioner, which leaves them one iteration. PETSc's own factors are sequential. */
static PetscErrorCode MakeIteration(EqmLinear linear)
{
  Petsc *const p = linear->data;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(linear->mesh->comm, &p->ksp));
  PetscCall(KSPSetType(p->ksp, KSPCG));
  PetscCall(KSPGetPC(p->ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  if (linear->mesh->size > 1) PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(KSPSetNormType(p->ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetOptionsPrefix(p->ksp, prefix));
  PetscFunctionReturn(0);
}

/* The assembled matrix in the type of -linear_mat_type. */
static PetscErrorCode TakeMatrix(EqmLinear linear)
{
  Petsc *const p = linear->data;
  Mat assembled;
  char type[64] = MATAIJ;
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &assembled));
  PetscCall(MatSetOption(assembled, MAT_SPD, PETSC_TRUE)); /* which conversions hand on */
  PetscCall(PetscOptionsGetString(NULL, prefix, "-mat_type", type, sizeof(type), NULL));
  PetscCall(PetscStrcmp(type, MATAIJ, &same));
  if (same && !p->matrix) {
    PetscCall(PetscObjectReference((PetscObject)assembled));
    p->matrix = assembled;
  } else if (!same) {
    PetscCall(MatConvert(assembled, type, p->matrix ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX, &p->matrix));
  }
  PetscFunctionReturn(0);
}

/* A vector like those of the matrix, of the type of -linear_vec_type. */
static PetscErrorCode CreateVec(EqmLinear linear, Vec *vector)
{
  PetscFunctionBegin;
  PetscCall(VecCreate(linear->mesh->comm, vector));
  PetscCall(VecSetSizes(*vector, linear->num_owned, PETSC_DETERMINE));
  PetscCall(VecSetOptionsPrefix(*vector, prefix));
  PetscCall(VecSetType(*vector, VECSTANDARD));
  PetscCall(VecSetFromOptions(*vector));
  PetscFunctionReturn(0);
}

static PetscErrorCode Analyse(EqmLinear linear, EqmOrdering ordering)
{
  Petsc *const p = linear->data;

  PetscFunctionBegin;
  PetscCall(CreateVec(linear, &p->b));
  PetscCall(CreateVec(linear, &p->x));
  PetscCall(MakeIteration(linear));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  Petsc *const p = linear->data;
  PCFailedReason failed;
  PC pc;

  PetscFunctionBegin;
  PetscCall(TakeMatrix(linear));
  PetscCall(KSPSetOperators(p->ksp, p->matrix, p->matrix));
  PetscCall(KSPSetTolerances(p->ksp, linear->tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetFromOptions(p->ksp));
  PetscCall(KSPSetUp(p->ksp));
  PetscCall(KSPGetPC(p->ksp, &pc));
  PetscCall(PCGetFailedReason(pc, &failed));
  *success = (PetscBool)(failed == PC_NOERROR);
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  Petsc *const p = linear->data;
  const PetscInt n = linear->num_owned;
  KSPConvergedReason reason;
  PetscInt iterations;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  for (PetscInt k = 0; k < num_rhs; k++) {
    const PetscScalar *solution;
    PetscScalar *right;
    PetscCall(VecGetArrayWrite(p->b, &right));
    PetscCall(PetscArraycpy(right, b + k * n, n));
    PetscCall(VecRestoreArrayWrite(p->b, &right));
    PetscCall(KSPSolve(p->ksp, p->b, p->x));
    PetscCall(KSPGetConvergedReason(p->ksp, &reason));
    PetscCall(KSPGetIterationNumber(p->ksp, &iterations));
    work->cg_iterations += iterations;
    if (reason <= 0) *success = PETSC_FALSE;
    PetscCall(VecGetArrayRead(p->x, &solution));
    PetscCall(PetscArraycpy(x + k * n, solution, n));
    PetscCall(VecRestoreArrayRead(p->x, &solution));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  Petsc *const p = linear->data;

  PetscFunctionBegin;
  PetscCall(KSPDestroy(&p->ksp));
  PetscCall(MatDestroy(&p->matrix));
  PetscCall(VecDestroy(&p->b));
  PetscCall(VecDestroy(&p->x));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearSetUpPetsc(EqmLinear linear)
{
  Petsc *p;

  PetscFunctionBegin;
  PetscCall(PetscNew(&p));
  linear->data = p;
  linear->analyse = Analyse;
  linear->factor = Factor;
  linear->solve = Solve;
  linear->destroy = Destroy;
  PetscFunctionReturn(0);
}
