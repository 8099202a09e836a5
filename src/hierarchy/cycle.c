/* Multigrid on the levels of a hierarchy: Galerkin products, one sweep before and its transpose after, so that a cycle
   is a symmetric operator; conjugate gradients by PETSc. */
#include "hierarchy/levelsystem.h"

typedef struct {
  const EqmBlockMatrix *matrix;
  EqmBlockMatrix own; /* of levels below the finest */
  const EqmProlongation *from_below;
  PetscReal *b, *x, *r;
} Level;

typedef struct {
  PetscInt num_levels;
  Level *level;
  EqmBlockFactor factor; /* of the coarsest */
} Cycle;

static PetscErrorCode CycleCreate(const EqmBlockMatrix *finest, PetscInt num_prolongations, const EqmProlongation *p,
                                  Cycle *cycle, PetscBool *success)
{
  const PetscInt last = num_prolongations;

  PetscFunctionBegin;
  *success = PETSC_TRUE;
  *cycle = (Cycle){.num_levels = last + 1};
  PetscCall(PetscCalloc1(cycle->num_levels, &cycle->level));
  for (PetscInt k = 0; k <= last; k++) {
    Level *const level = &cycle->level[k];
    PetscBool definite = PETSC_TRUE;
    level->matrix = k == 0 ? finest : &level->own;
    level->from_below = k < last ? &p[k] : NULL;
    if (k > 0) PetscCall(EqmProlongationGalerkin(&p[k - 1], cycle->level[k - 1].matrix, &level->own));
    if (k > 0) PetscCall(EqmBlockMatrixInvertDiagonal(&level->own, &definite));
    *success = (PetscBool)(*success && definite);
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->b));
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->x));
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->r));
  }
  if (*success) PetscCall(EqmBlockFactorCreate(cycle->level[last].matrix, &cycle->factor, success));
  PetscFunctionReturn(0);
}

static PetscErrorCode CycleDestroy(Cycle *cycle)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < cycle->num_levels; k++) {
    PetscCall(EqmBlockMatrixReset(&cycle->level[k].own));
    PetscCall(PetscFree(cycle->level[k].b));
    PetscCall(PetscFree(cycle->level[k].x));
    PetscCall(PetscFree(cycle->level[k].r));
  }
  PetscCall(EqmBlockFactorDestroy(&cycle->factor));
  PetscCall(PetscFree(cycle->level));
  PetscFunctionReturn(0);
}

/* x = B b on a level and those below. */
static PetscErrorCode Descend(Cycle *cycle, PetscInt k, PetscReal *b, PetscReal *x)
{
  Level *const level = &cycle->level[k];
  const PetscInt n = level->matrix->num_rows;

  PetscFunctionBegin;
  if (k + 1 == cycle->num_levels) {
    PetscBool success;
    PetscCall(EqmBlockFactorSolve(&cycle->factor, b, x, &success));
    PetscFunctionReturn(0);
  }
  EqmBlockMatrixSweepForward(level->matrix, b, x);
  EqmBlockMatrixResidual(level->matrix, b, x, level->r);
  EqmProlongationRestrict(level->from_below, level->r, level[1].b);
  PetscCall(Descend(cycle, k + 1, level[1].b, level[1].x));
  EqmProlongationAdd(level->from_below, level[1].x, x);
  EqmBlockMatrixResidual(level->matrix, b, x, level->r);
  EqmBlockMatrixSweepBackward(level->matrix, level->r, level->b); /* where b is this, nobody needs it any more */
  for (PetscInt i = 0; i < 2 * n; i++) x[i] += level->b[i];
  PetscFunctionReturn(0);
}

static PetscErrorCode MultiplyShell(Mat shell, Vec x, Vec y)
{
  const EqmBlockMatrix *matrix;
  const PetscScalar *from;
  PetscScalar *to;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &matrix));
  PetscCall(VecGetArrayRead(x, &from));
  PetscCall(VecGetArrayWrite(y, &to));
  EqmBlockMatrixMultiply(matrix, from, to);
  PetscCall(VecRestoreArrayWrite(y, &to));
  PetscCall(VecRestoreArrayRead(x, &from));
  PetscFunctionReturn(0);
}

static PetscErrorCode ApplyShell(PC shell, Vec b, Vec x)
{
  Cycle *cycle;
  PetscScalar *from, *to;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(shell, &cycle));
  PetscCall(VecGetArray(b, &from));
  PetscCall(VecGetArrayWrite(x, &to));
  PetscCall(Descend(cycle, 0, from, to));
  PetscCall(VecRestoreArrayWrite(x, &to));
  PetscCall(VecRestoreArray(b, &from));
  PetscFunctionReturn(0);
}

/* PETSc's conjugate gradients with the cycle. */
static PetscErrorCode SolveWithCycle(EqmLevelSystem *system, Cycle *cycle, PetscReal tolerance, PetscInt *iterations,
                                     PetscBool *success)
{
  enum { MOST_ITERATIONS = 60 };
  const PetscInt n = 2 * system->matrix.num_rows;
  KSPConvergedReason reason;
  Vec right, solution;
  Mat shell;
  KSP ksp;
  PC pc;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(PETSC_COMM_SELF, n, n, n, n, (void *)&system->matrix, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))MultiplyShell));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, system->right, &right));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, system->solution, &solution));
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NATURAL));
  PetscCall(KSPSetTolerances(ksp, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, MOST_ITERATIONS));
  PetscCall(KSPSetOperators(ksp, shell, shell));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, cycle));
  PetscCall(PCShellSetApply(pc, ApplyShell));
  PetscCall(KSPSolve(ksp, right, solution));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(KSPGetIterationNumber(ksp, iterations));
  *success = (PetscBool)(reason > 0 || reason == KSP_DIVERGED_ITS);
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&shell));
  PetscCall(VecDestroy(&right));
  PetscCall(VecDestroy(&solution));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemMultigridSolve(EqmLevelSystem *system, PetscInt num_prolongations,
                                            const EqmProlongation *prolongation, PetscReal tolerance,
                                            PetscInt *iterations, PetscBool *success)
{
  Cycle cycle;

  PetscFunctionBegin;
  *iterations = 0;
  PetscCall(CycleCreate(&system->matrix, num_prolongations, prolongation, &cycle, success));
  if (*success) PetscCall(SolveWithCycle(system, &cycle, tolerance, iterations, success));
  PetscCall(CycleDestroy(&cycle));
  PetscFunctionReturn(0);
}
