/* PETSc's multigrid on shared levels: Galerkin products, one sweep on each rank before and
   the transpose after. */
#include "hierarchy/sharedsolve.h"

/* The rows of this rank's vertices: the system's own arrays, but for new columns. */
static PetscErrorCode SystemRows(const EqmSharedLevel *shared, const EqmLevelSystem *system, EqmSharedRows *rows)
{
  const EqmBlockMatrix *const a = &system->matrix;
  const PetscInt length = a->start[shared->num_owned];

  PetscFunctionBegin;
  *rows = (EqmSharedRows){.num_rows = shared->num_owned, .first = shared->first, .start = a->start, .entry = a->entry};
  PetscCall(PetscMalloc1(length, &rows->column));
  for (PetscInt q = 0; q < length; q++) rows->column[q] = EqmSharedGlobal(shared, a->column[q]);
  PetscFunctionReturn(0);
}

/* One sweep from zero. */
static PetscErrorCode SetSmoother(KSP smoother, MatSORType sweep)
{
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPSetType(smoother, KSPRICHARDSON));
  PetscCall(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 1));
  PetscCall(KSPSetNormType(smoother, KSP_NORM_NONE));
  PetscCall(KSPGetPC(smoother, &pc));
  PetscCall(PCSetType(pc, PCSOR));
  PetscCall(PCSORSetSymmetric(pc, sweep));
  PetscFunctionReturn(0);
}

/* `finest`: the system's rows; `matrix`: as PETSc's. Collective. */
static PetscErrorCode SetMultigrid(MPI_Comm comm, PC pc, const EqmSharedRows *finest, Mat matrix,
                                   const EqmSharedProlongations *prolongations)
{
  const PetscInt num = prolongations->num;
  const EqmSharedRows *at = finest;
  EqmSharedRows rows = {.start = NULL}, coarser;

  PetscFunctionBegin;
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, num + 1, NULL));
  PetscCall(PetscObjectReference((PetscObject)matrix));
  for (PetscInt level = num; level >= 0; level--) {
    const PetscInt k = num - level;
    KSP before, after;
    PetscCall(PCMGGetSmootherDown(pc, level, &before));
    PetscCall(KSPSetOperators(before, matrix, matrix));
    if (level > 0) {
      PetscCall(PCMGSetInterpolation(pc, level, prolongations->matrix[k]));
      PetscCall(PCMGGetSmootherUp(pc, level, &after));
      PetscCall(KSPSetOperators(after, matrix, matrix));
      PetscCall(SetSmoother(before, SOR_LOCAL_FORWARD_SWEEP));
      PetscCall(SetSmoother(after, SOR_LOCAL_BACKWARD_SWEEP));
    }
    PetscCall(MatDestroy(&matrix));
    if (level == 0) break;
    PetscCall(EqmSharedGalerkin(comm, at, &prolongations->rows[k], prolongations->num_coarse[k], &coarser));
    PetscCall(EqmSharedRowsDestroy(&rows));
    rows = coarser;
    at = &rows;
    PetscCall(EqmSharedRowsMatrix(comm, at, rows.num_rows, &matrix));
  }
  PetscCall(EqmSharedRowsDestroy(&rows));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedSolve(const EqmSharedLevel *shared, EqmLevelSystem *system,
                              const EqmSharedProlongations *prolongations, PetscReal tolerance, PetscInt *iterations,
                              PetscBool *success)
{
  enum { MOST_ITERATIONS = 60 };
  KSPConvergedReason reason;
  EqmSharedRows rows;
  Vec right, solution;
  Mat matrix;
  KSP ksp;
  PC pc;

  PetscFunctionBegin;
  PetscCall(SystemRows(shared, system, &rows));
  PetscCall(EqmSharedRowsMatrix(shared->comm, &rows, shared->num_owned, &matrix));
  PetscCall(VecCreateMPIWithArray(shared->comm, 1, 2 * shared->num_owned, PETSC_DETERMINE, system->right, &right));
  PetscCall(
      VecCreateMPIWithArray(shared->comm, 1, 2 * shared->num_owned, PETSC_DETERMINE, system->solution, &solution));
  PetscCall(KSPCreate(shared->comm, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NATURAL));
  PetscCall(KSPSetTolerances(ksp, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, MOST_ITERATIONS));
  PetscCall(KSPSetOperators(ksp, matrix, matrix));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(SetMultigrid(shared->comm, pc, &rows, matrix, prolongations));
  PetscCall(PetscFree(rows.column));
  PetscCall(KSPSolve(ksp, right, solution));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(KSPGetIterationNumber(ksp, iterations));
  *success = (PetscBool)(reason > 0 || reason == KSP_DIVERGED_ITS);
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&matrix));
  PetscCall(VecDestroy(&right));
  PetscCall(VecDestroy(&solution));
  PetscCall(EqmSharedUpdateGhosts(shared, 2, system->solution));
  PetscFunctionReturn(0);
}
