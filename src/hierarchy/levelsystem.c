/* Linear systems on a level: the pattern, and the entries cell by cell. */
#include "hierarchy/levelsystem.h"
#include "hierarchy/level.h"

/* The neighbours of a vertex and itself, ascending; `seen` is scratch. Returns how many. */
static PetscInt Neighbours(const EqmHierarchyLevel *level, const EqmCorners *corners, PetscInt v, PetscInt *seen,
                           PetscInt *neighbour)
{
  PetscInt n = 0;

  neighbour[n++] = v;
  seen[v] = v + 1;
  for (PetscInt k = corners->start[v]; k < corners->start[v + 1]; k++) {
    for (PetscInt a = 0; a < 3; a++) {
      const PetscInt u = level->cells[3 * (corners->corner[k] / 3) + a];
      if (seen[u] == v + 1) continue;
      seen[u] = v + 1;
      neighbour[n++] = u;
    }
  }
  (void)PetscSortInt(n, neighbour);
  return n;
}

/* Rows, columns, and where each cell's entries go. */
static PetscErrorCode MakePattern(EqmLevelSystem *system, const unsigned char *count)
{
  const EqmHierarchyLevel *const level = system->level;
  EqmCorners corners;
  PetscInt *seen, *neighbour, at = 0, most = 0;

  PetscFunctionBegin;
  PetscCall(EqmCornersCreate(level->num_vertices, level->num_cells, level->cells, &corners));
  for (PetscInt v = 0; v < level->num_vertices; v++) most = PetscMax(most, corners.start[v + 1] - corners.start[v]);
  PetscCall(PetscCalloc1(level->num_vertices, &seen));
  PetscCall(PetscMalloc1(most + 2, &neighbour));
  PetscCall(PetscMalloc1(system->num_unknowns + 1, &system->row));
  PetscCall(
      PetscMalloc1(4 * (6 * level->num_cells / 2 + 2 * level->num_vertices + level->num_boundary), &system->column));
  for (PetscInt v = 0; v < level->num_vertices; v++) {
    const PetscInt n = Neighbours(level, &corners, v, seen, neighbour), begin = at;
    for (PetscInt k = 0; k < count[v]; k++) {
      system->row[system->first[v] + k] = at;
      for (PetscInt m = 0; m < n; m++) {
        for (PetscInt l = 0; l < count[neighbour[m]]; l++) system->column[at++] = system->first[neighbour[m]] + l;
      }
    }
    for (PetscInt k = corners.start[v]; k < corners.start[v + 1] && count[v] > 0; k++) {
      const PetscInt c = corners.corner[k] / 3, a = corners.corner[k] % 3;
      for (PetscInt b = 0; b < 3; b++) {
        const PetscInt wanted = system->first[level->cells[3 * c + b]];
        PetscInt place = begin;
        while (count[level->cells[3 * c + b]] > 0 && system->column[place] != wanted) place++;
        system->offset[9 * c + 3 * a + b] = (int)(place - begin);
      }
    }
  }
  system->row[system->num_unknowns] = at;
  PetscCall(PetscFree(seen));
  PetscCall(PetscFree(neighbour));
  PetscCall(EqmCornersDestroy(&corners));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemCreate(const EqmHierarchyLevel *level, const unsigned char *count, EqmLevelSystem *system)
{
  PetscInt n;

  PetscFunctionBegin;
  system->level = level;
  PetscCall(PetscMalloc1(level->num_vertices + 1, &system->first));
  system->first[0] = 0;
  for (PetscInt v = 0; v < level->num_vertices; v++) system->first[v + 1] = system->first[v] + count[v];
  n = system->num_unknowns = system->first[level->num_vertices];
  PetscCall(PetscCalloc1(9 * level->num_cells, &system->offset));
  PetscCall(MakePattern(system, count));
  PetscCall(PetscMalloc1(system->row[n], &system->entry));
  PetscCall(PetscMalloc1(n, &system->right));
  PetscCall(
      MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, system->row, system->column, system->entry, &system->matrix));
  PetscCall(MatSetOption(system->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatCreateVecs(system->matrix, &system->solution, NULL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemDestroy(EqmLevelSystem *system)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&system->matrix));
  PetscCall(VecDestroy(&system->solution));
  PetscCall(PetscFree(system->first));
  PetscCall(PetscFree(system->row));
  PetscCall(PetscFree(system->column));
  PetscCall(PetscFree(system->entry));
  PetscCall(PetscFree(system->right));
  PetscCall(PetscFree(system->offset));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemClear(EqmLevelSystem *system)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(system->entry, system->row[system->num_unknowns]));
  PetscCall(PetscArrayzero(system->right, system->num_unknowns));
  PetscFunctionReturn(0);
}

void EqmLevelSystemAdd(EqmLevelSystem *system, PetscInt cell, const PetscReal *matrix, const PetscReal *right)
{
  const PetscInt *const v = system->level->cells + 3 * cell, *const first = system->first;
  const int *const offset = system->offset + 9 * cell;
  PetscInt size = 0, r = 0;

  for (PetscInt a = 0; a < 3; a++) size += first[v[a] + 1] - first[v[a]];
  for (PetscInt a = 0; a < 3; a++) {
    for (PetscInt row = first[v[a]]; row < first[v[a] + 1]; row++, r++) {
      PetscInt c = 0;
      system->right[row] += right[r];
      for (PetscInt b = 0; b < 3; b++) {
        PetscReal *const to = system->entry + system->row[row] + offset[3 * a + b];
        for (PetscInt k = 0; k < first[v[b] + 1] - first[v[b]]; k++) to[k] += matrix[size * r + c++];
      }
    }
  }
}

PetscErrorCode EqmLevelSystemShift(EqmLevelSystem *system, PetscReal shift)
{
  PetscFunctionBegin;
  for (PetscInt r = 0; r < system->num_unknowns; r++) {
    for (PetscInt k = system->row[r]; k < system->row[r + 1]; k++) {
      if (system->column[k] == r) system->entry[k] *= 1. + shift;
    }
  }
  PetscCall(MatAssemblyBegin(system->matrix, MAT_FINAL_ASSEMBLY)); /* its entries are new */
  PetscCall(MatAssemblyEnd(system->matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

static PetscErrorCode SolveWith(EqmLevelSystem *system, KSP ksp, PetscInt *iterations, PetscBool *success)
{
  KSPConvergedReason reason;
  Vec right;

  PetscFunctionBegin;
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, system->num_unknowns, system->right, &right));
  PetscCall(KSPSetOperators(ksp, system->matrix, system->matrix));
  PetscCall(KSPSolve(ksp, right, system->solution));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(KSPGetIterationNumber(ksp, iterations));
  *success = (PetscBool)(reason > 0 || reason == KSP_DIVERGED_ITS);
  PetscCall(VecDestroy(&right));
  PetscFunctionReturn(0);
}

/* Make a KSP that factors. */
static PetscErrorCode SetDirect(KSP ksp)
{
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCCHOLESKY));
  PetscCall(PCFactorSetMatOrderingType(pc, MATORDERINGND));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemFactorSolve(EqmLevelSystem *system, PetscBool *success)
{
  PetscInt iterations;
  KSP ksp;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(SetDirect(ksp));
  PetscCall(SolveWith(system, ksp, &iterations, success));
  PetscCall(KSPDestroy(&ksp));
  PetscFunctionReturn(0);
}

/* One sweep over the vertices, whose rows PETSc takes together. */
static PetscErrorCode SetSmoother(KSP ksp, MatSORType type)
{
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPSetType(ksp, KSPRICHARDSON));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NONE));
  PetscCall(KSPSetTolerances(ksp, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 1));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSOR));
  PetscCall(PCSORSetSymmetric(pc, type));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetMultigrid(KSP ksp, PetscInt num, const Mat *prolongation)
{
  KSP level;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, num + 1, NULL));
  PetscCall(PCMGSetGalerkin(pc, PC_MG_GALERKIN_BOTH));
  for (PetscInt k = 0; k < num; k++) { /* PETSc counts levels from the coarsest */
    PetscCall(PCMGSetInterpolation(pc, num - k, prolongation[k]));
    PetscCall(PCMGGetSmootherDown(pc, num - k, &level));
    PetscCall(SetSmoother(level, SOR_LOCAL_FORWARD_SWEEP));
    PetscCall(PCMGGetSmootherUp(pc, num - k, &level));
    PetscCall(SetSmoother(level, SOR_LOCAL_BACKWARD_SWEEP));
  }
  PetscCall(PCMGGetCoarseSolve(pc, &level));
  PetscCall(SetDirect(level));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemMultigridSolve(EqmLevelSystem *system, PetscInt num_prolongations, const Mat *prolongation,
                                            PetscReal tolerance, PetscInt *iterations, PetscBool *success)
{
  enum { MOST_ITERATIONS = 60 };
  KSP ksp;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_NATURAL));
  PetscCall(KSPSetTolerances(ksp, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, MOST_ITERATIONS));
  PetscCall(SetMultigrid(ksp, num_prolongations, prolongation));
  PetscCall(SolveWith(system, ksp, iterations, success));
  PetscCall(KSPDestroy(&ksp));
  PetscFunctionReturn(0);
}
