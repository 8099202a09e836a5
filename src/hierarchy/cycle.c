#include "hierarchy/cycle.h"
#include "hierarchy/conjugate.h"

typedef struct {
  const EqmBlockMatrix *matrix;
  EqmBlockMatrix own; /* of levels below the finest */
  EqmSweeps sweeps;   /* of levels above the coarsest */
  const EqmProlongation *from_below;
  PetscReal *b, *x, *r;
} Level;

struct _p_EqmCycle {
  PetscInt num_levels;
  Level *level;
  EqmBlockFactor factor; /* of the coarsest */
};

PetscErrorCode EqmCycleCreate(const EqmBlockMatrix *finest, PetscInt num_prolongations, const EqmProlongation *p,
                              EqmCycle *out)
{
  const PetscInt last = num_prolongations;
  EqmCycle cycle;

  PetscFunctionBegin;
  PetscCall(PetscNew(&cycle));
  cycle->num_levels = last + 1;
  PetscCall(PetscCalloc1(cycle->num_levels, &cycle->level));
  for (PetscInt k = 0; k <= last; k++) {
    Level *const level = &cycle->level[k];
    level->matrix = k == 0 ? finest : &level->own;
    level->from_below = k < last ? &p[k] : NULL;
    if (k > 0) PetscCall(EqmProlongationGalerkinPattern(&p[k - 1], cycle->level[k - 1].matrix, &level->own));
    if (k < last) PetscCall(EqmSweepsCreateEven(level->matrix, &level->sweeps));
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->b));
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->x));
    PetscCall(PetscMalloc1(2 * level->matrix->num_rows, &level->r));
  }
  PetscCall(EqmBlockFactorCreate(cycle->level[last].matrix, &cycle->factor));
  *out = cycle;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCycleFill(EqmCycle cycle, PetscBool *success)
{
  const PetscInt last = cycle->num_levels - 1;

  PetscFunctionBegin;
  *success = PETSC_TRUE;
  for (PetscInt k = 0; k <= last; k++) {
    Level *const level = &cycle->level[k];
    if (k > 0) {
      PetscCall(EqmProlongationGalerkinFill(level[-1].from_below, level[-1].matrix, &level->own));
      PetscCall(EqmBlockMatrixCompleteDiagonal(&level->own, success));
      if (!*success) PetscFunctionReturn(0);
    }
    if (k < last) EqmSweepsFill(&level->sweeps, level->matrix);
  }
  PetscCall(EqmBlockFactorFill(cycle->level[last].matrix, &cycle->factor, success));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCycleDestroy(EqmCycle *out)
{
  EqmCycle cycle = *out;

  PetscFunctionBegin;
  if (!cycle) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < cycle->num_levels; k++) {
    PetscCall(EqmBlockMatrixReset(&cycle->level[k].own));
    PetscCall(EqmSweepsDestroy(&cycle->level[k].sweeps));
    PetscCall(PetscFree(cycle->level[k].b));
    PetscCall(PetscFree(cycle->level[k].x));
    PetscCall(PetscFree(cycle->level[k].r));
  }
  PetscCall(EqmBlockFactorDestroy(&cycle->factor));
  PetscCall(PetscFree(cycle->level));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

/* x = B b on a level and those below. */
static PetscErrorCode Descend(EqmCycle cycle, PetscInt k, const PetscReal *b, PetscReal *x)
{
  Level *const level = &cycle->level[k];

  PetscFunctionBegin;
  if (k + 1 == cycle->num_levels) {
    PetscBool success;
    PetscCall(EqmBlockFactorSolve(&cycle->factor, b, x, &success));
    PetscFunctionReturn(0);
  }
  EqmSweepForward(&level->sweeps, b, x, level->r);
  EqmSweepResidual(&level->sweeps, x, level->r);
  EqmProlongationRestrict(level->from_below, level->r, level[1].b);
  PetscCall(Descend(cycle, k + 1, level[1].b, level[1].x));
  EqmProlongationAdd(level->from_below, level[1].x, x);
  EqmSweepBackward(&level->sweeps, b, x, level->r);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCycleApply(EqmCycle cycle, const PetscReal *b, PetscReal *x)
{
  PetscFunctionBegin;
  PetscCall(Descend(cycle, 0, b, x));
  PetscFunctionReturn(0);
}

static PetscErrorCode Precondition(void *context, const PetscReal *b, PetscReal *x)
{
  PetscFunctionBegin;
  PetscCall(EqmCycleApply(context, b, x));
  PetscFunctionReturn(0);
}

static PetscErrorCode Multiply(void *context, const PetscReal *x, PetscReal *y)
{
  PetscFunctionBegin;
  EqmBlockMatrixMultiply(((EqmCycle)context)->level[0].matrix, x, y);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCycleSolve(EqmCycle cycle, PetscReal *b, PetscReal *x, PetscReal tolerance, PetscInt *iterations,
                             PetscBool *success)
{
  PetscFunctionBegin;
  PetscCall(EqmConjugateGradients(PETSC_COMM_SELF, 2 * cycle->level[0].matrix->num_rows, Multiply, Precondition, cycle,
                                  b, x, tolerance, iterations, success));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelSystemMultigridSolve(EqmLevelSystem *system, PetscInt num_prolongations,
                                            const EqmProlongation *prolongation, PetscReal tolerance,
                                            PetscInt *iterations, PetscBool *success)
{
  EqmCycle cycle;

  PetscFunctionBegin;
  *iterations = 0;
  PetscCall(EqmCycleCreate(&system->matrix, num_prolongations, prolongation, &cycle));
  PetscCall(EqmCycleFill(cycle, success));
  if (*success) PetscCall(EqmCycleSolve(cycle, system->right, system->solution, tolerance, iterations, success));
  PetscCall(EqmCycleDestroy(&cycle));
  PetscFunctionReturn(0);
}
