/* Matrices of a shared level in PETSc's form, and its multigrid: Galerkin products, one sweep on each rank before and
   the transpose after. */
#include "hierarchy/sharedsolve.h"

/* A block row with ascending columns. Returns how many. */
static PetscInt SortRow(PetscInt begin, PetscInt end, const PetscInt *column, PetscInt *place)
{
  PetscInt n = 0;

  for (PetscInt q = begin; q < end; q++) {
    PetscInt at = n;
    if (column[q] < 0) continue;
    for (; at > 0 && column[place[at - 1]] > column[q]; at--) place[at] = place[at - 1];
    place[at] = q;
    n++;
  }
  return n;
}

PetscErrorCode EqmSharedMatrix(MPI_Comm comm, PetscInt num_rows, PetscInt num_columns, const PetscInt *start,
                               const PetscInt *column, const EqmBlock *entry, Mat *matrix)
{
  PetscInt *row, *col, *place, most = 0, at = 0;
  PetscReal *value;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < num_rows; i++) most = PetscMax(most, start[i + 1] - start[i]);
  PetscCall(PetscMalloc1(most, &place));
  PetscCall(PetscMalloc3(2 * num_rows + 1, &row, 4 * start[num_rows], &col, 4 * start[num_rows], &value));
  row[0] = 0;
  for (PetscInt i = 0; i < num_rows; i++) {
    const PetscInt n = SortRow(start[i], start[i + 1], column, place);
    for (PetscInt k = 0; k < 2; k++) {
      for (PetscInt q = 0; q < 2 * n; q++) {
        const PetscReal e = entry[place[q / 2]].e[2 * k + q % 2];
        if (e == 0.) continue;
        col[at] = 2 * column[place[q / 2]] + q % 2;
        value[at++] = e;
      }
      row[2 * i + k + 1] = at;
    }
  }
  PetscCall(MatCreateMPIAIJWithArrays(comm, 2 * num_rows, 2 * num_columns, PETSC_DETERMINE, PETSC_DETERMINE, row, col,
                                      value, matrix));
  PetscCall(PetscFree3(row, col, value));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(0);
}

/* The rows of this rank's vertices. Collective. */
static PetscErrorCode SystemMatrix(const EqmSharedLevel *shared, const EqmLevelSystem *system, Mat *matrix)
{
  const EqmBlockMatrix *const a = &system->matrix;
  const PetscInt length = a->start[shared->num_owned];
  PetscInt *column;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(length, &column));
  for (PetscInt q = 0; q < length; q++) column[q] = EqmSharedGlobal(shared, a->column[q]);
  PetscCall(EqmSharedMatrix(shared->comm, shared->num_owned, shared->num_owned, a->start, column, a->entry, matrix));
  PetscCall(PetscFree(column));
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

static PetscErrorCode SetMultigrid(PC pc, const EqmSharedProlongations *prolongations)
{
  const PetscInt num = prolongations->num;

  PetscFunctionBegin;
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, num + 1, NULL));
  PetscCall(PCMGSetGalerkin(pc, PC_MG_GALERKIN_BOTH));
  for (PetscInt level = 1; level <= num; level++) {
    KSP before, after;
    PetscCall(PCMGSetInterpolation(pc, level, prolongations->matrix[num - level]));
    PetscCall(PCMGGetSmootherDown(pc, level, &before));
    PetscCall(PCMGGetSmootherUp(pc, level, &after));
    PetscCall(SetSmoother(before, SOR_LOCAL_FORWARD_SWEEP));
    PetscCall(SetSmoother(after, SOR_LOCAL_BACKWARD_SWEEP));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedSolve(const EqmSharedLevel *shared, EqmLevelSystem *system,
                              const EqmSharedProlongations *prolongations, PetscReal tolerance, PetscInt *iterations,
                              PetscBool *success)
{
  enum { MOST_ITERATIONS = 60 };
  KSPConvergedReason reason;
  Vec right, solution;
  Mat matrix;
  KSP ksp;
  PC pc;

  PetscFunctionBegin;
  PetscCall(SystemMatrix(shared, system, &matrix));
  PetscCall(VecCreateMPIWithArray(shared->comm, 1, 2 * shared->num_owned, PETSC_DETERMINE, system->right, &right));
  PetscCall(
      VecCreateMPIWithArray(shared->comm, 1, 2 * shared->num_owned, PETSC_DETERMINE, system->solution, &solution));
  PetscCall(KSPCreate(shared->comm, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NATURAL));
  PetscCall(KSPSetTolerances(ksp, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, MOST_ITERATIONS));
  PetscCall(KSPSetOperators(ksp, matrix, matrix));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(SetMultigrid(pc, prolongations));
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
