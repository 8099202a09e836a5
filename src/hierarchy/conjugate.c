#include "hierarchy/conjugate.h"

typedef struct {
  EqmOperator multiply, precondition;
  void *context;
} Operators;

static PetscErrorCode Apply(EqmOperator operate, void *context, Vec from, Vec to)
{
  const PetscScalar *given;
  PetscScalar *taken;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(from, &given));
  PetscCall(VecGetArrayWrite(to, &taken));
  PetscCall(operate(context, given, taken));
  PetscCall(VecRestoreArrayWrite(to, &taken));
  PetscCall(VecRestoreArrayRead(from, &given));
  PetscFunctionReturn(0);
}

static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  const Operators *operators;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &operators));
  PetscCall(Apply(operators->multiply, operators->context, x, y));
  PetscFunctionReturn(0);
}

static PetscErrorCode Precondition(PC shell, Vec b, Vec x)
{
  const Operators *operators;

  PetscFunctionBegin;
  PetscCall(PCShellGetContext(shell, &operators));
  PetscCall(Apply(operators->precondition, operators->context, b, x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmConjugateGradients(MPI_Comm comm, PetscInt n, EqmOperator multiply, EqmOperator precondition,
                                     void *context, PetscReal *b, PetscReal *x, PetscReal tolerance,
                                     PetscInt *iterations, PetscBool *success)
{
  enum { MOST_ITERATIONS = 60 };
  Operators operators = {multiply, precondition, context};
  KSPConvergedReason reason;
  Vec right, solution;
  Mat shell;
  KSP ksp;
  PC pc;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(comm, n, n, PETSC_DETERMINE, PETSC_DETERMINE, &operators, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(VecCreateMPIWithArray(comm, 1, n, PETSC_DETERMINE, b, &right));
  PetscCall(VecCreateMPIWithArray(comm, 1, n, PETSC_DETERMINE, x, &solution));
  PetscCall(KSPCreate(comm, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NATURAL));
  PetscCall(KSPSetTolerances(ksp, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, MOST_ITERATIONS));
  PetscCall(KSPSetOperators(ksp, shell, shell));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, &operators));
  PetscCall(PCShellSetApply(pc, Precondition));
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
