#include "hierarchy/sharedcycle.h"
#include "hierarchy/conjugate.h"
#include "hierarchy/sharedbottom.h"
#include "hierarchy/sharedprolongation.h"
#include "hierarchy/movedrows.h"
#include "hierarchy/sweeps.h"
#include "base/rows.h"

typedef struct {
  const EqmBlockMatrix *matrix; /* rows of this rank; columns: they, then ghosts */
  PetscInt num_ghosts;
  PetscSF halo;
  EqmSweeps sweeps;
  EqmSharedProlongation from_below;
  EqmBlockMatrix product; /* the next level's matrix, where the rows of this one are */
  EqmMovedRows below;     /* and where that level has them */
  PetscReal *x, *r;       /* two per row; x has ghosts behind them */
  PetscReal *coarse, *b;  /* per vertex of the next level: where this one has it, and where it is */
} Level;

struct _p_EqmSharedCycle {
  MPI_Comm comm;
  const EqmSharedLevel *shared;
  EqmLevelSystem *system;
  EqmBlockMatrix finest; /* the system's rows of this rank; owns nothing */
  PetscInt num_levels;   /* those of the first rank left out */
  Level *level;
  EqmSharedBottom bottom; /* these */
};

/* ---- patterns */

static PetscErrorCode CreateLevel(const EqmSharedLevel *shared, const EqmLevelMap *map, PetscBool last, Level *level)
{
  EqmProlongation *const p = &level->from_below.prolongation;
  const PetscInt n = level->matrix->num_rows;

  PetscFunctionBegin;
  PetscCall(EqmSharedProlongationCreate(shared, map, shared + 1, last, level->num_ghosts, &level->from_below));
  PetscCall(EqmSharedProlongationFetch(level->halo, level->num_ghosts, &level->from_below));
  PetscCall(EqmSweepsCreate(level->matrix, shared->num_pieces, shared->vertex_start, &level->sweeps));
  PetscCall(EqmProlongationGalerkinPattern(p, level->matrix, &level->product));
  PetscCall(EqmMovedRowsCreate(level->from_below.rows, &level->product, level->from_below.number, &level->below));
  PetscCall(PetscMalloc1(2 * (n + level->num_ghosts), &level->x));
  PetscCall(PetscMalloc1(2 * n, &level->r));
  PetscCall(PetscMalloc1(2 * p->num_coarse, &level->coarse));
  PetscCall(PetscMalloc1(2 * level->below.matrix.num_rows, &level->b));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedCycleCreate(EqmShared shared, PetscInt k, EqmCascadeTarget target, const EqmLevelMap *map,
                                    PetscInt most, EqmLevelSystem *system, EqmSharedCycle *out)
{
  const EqmSharedLevel *const finest = &shared->level[k];
  const PetscInt num = shared->num_levels - 1 - k;
  EqmLevelMap own[EQM_MOST_LEVELS];
  EqmSharedCycle cycle;

  PetscFunctionBegin;
  PetscCheck(num > 0, shared->comm, PETSC_ERR_ARG_OUTOFRANGE, "there is no shared level below %" PetscInt_FMT, k);
  PetscCall(PetscNew(&cycle));
  cycle->comm = shared->comm;
  cycle->shared = finest;
  cycle->system = system;
  cycle->finest = system->matrix;
  cycle->finest.num_rows = finest->num_owned;
  cycle->num_levels = num;
  PetscCall(PetscCalloc1(num, &cycle->level));
  for (PetscInt j = 0; j < num; j++) {
    Level *const level = &cycle->level[j];
    level->matrix = j == 0 ? &cycle->finest : &level[-1].below.matrix;
    level->num_ghosts = j == 0 ? finest->level.num_vertices - finest->num_owned : level[-1].below.num_ghosts;
    level->halo = j == 0 ? finest->halo : level[-1].below.halo;
    PetscCall(CreateLevel(finest + j, j == 0 ? map : &own[j], (PetscBool)(j == num - 1), level));
    PetscCall(EqmSharedMapCreate(finest + j + 1, target, j == 0 ? map->x : own[j].x, &own[j + 1]));
  }
  PetscCall(
      EqmSharedBottomCreate(shared, target, &own[num], most, &cycle->level[num - 1].below.matrix, &cycle->bottom));
  for (PetscInt j = 0; j < num; j++) PetscCall(EqmLevelMapDestroy(&own[j + 1]));
  *out = cycle;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedCycleDestroy(EqmSharedCycle *out)
{
  EqmSharedCycle cycle = *out;

  PetscFunctionBegin;
  if (!cycle) PetscFunctionReturn(0);
  for (PetscInt j = 0; j < cycle->num_levels; j++) {
    Level *const level = &cycle->level[j];
    PetscCall(EqmSweepsDestroy(&level->sweeps));
    PetscCall(EqmSharedProlongationDestroy(&level->from_below));
    PetscCall(EqmBlockMatrixReset(&level->product));
    PetscCall(EqmMovedRowsDestroy(&level->below));
    PetscCall(PetscFree(level->x));
    PetscCall(PetscFree(level->r));
    PetscCall(PetscFree(level->coarse));
    PetscCall(PetscFree(level->b));
  }
  PetscCall(EqmSharedBottomDestroy(&cycle->bottom));
  PetscCall(PetscFree(cycle->level));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

/* ---- entries */

PetscErrorCode EqmSharedCycleFill(EqmSharedCycle cycle, PetscBool *success)
{
  PetscFunctionBegin;
  *success = PETSC_TRUE;
  for (PetscInt j = 0; j < cycle->num_levels && *success; j++) {
    Level *const level = &cycle->level[j];
    EqmSweepsFill(&level->sweeps, level->matrix);
    PetscCall(EqmProlongationGalerkinFill(&level->from_below.prolongation, level->matrix, &level->product));
    PetscCall(EqmMovedRowsFill(&level->product, &level->below));
    PetscCall(EqmBlockMatrixCompleteDiagonal(&level->below.matrix, success));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, cycle->comm));
  }
  if (*success) PetscCall(EqmSharedBottomFill(cycle->bottom, success));
  PetscFunctionReturn(0);
}

/* ---- solutions */

static PetscErrorCode UpdateGhosts(Level *level)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsToLeaves(level->halo, 2, level->x, level->x + 2 * level->matrix->num_rows));
  PetscFunctionReturn(0);
}

/* level->x = B b on level j and those below. */
static PetscErrorCode Descend(EqmSharedCycle cycle, PetscInt j, const PetscReal *b)
{
  Level *const level = &cycle->level[j];
  const EqmProlongation *const p = &level->from_below.prolongation;
  PetscReal *below = level->b;

  PetscFunctionBegin;
  EqmSweepForward(&level->sweeps, b, level->x, level->r);
  PetscCall(UpdateGhosts(level));
  EqmSweepResidual(&level->sweeps, level->x, level->r);
  EqmProlongationRestrict(p, level->r, level->coarse);
  PetscCall(EqmRowsToLeaves(level->from_below.rows, 2, level->coarse, level->b));
  if (j + 1 < cycle->num_levels) {
    PetscCall(Descend(cycle, j + 1, level->b));
    below = level[1].x;
  } else {
    PetscCall(EqmSharedBottomApply(cycle->bottom, level->b, &below));
  }
  PetscCall(EqmRowsToRoots(level->from_below.rows, 2, below, level->coarse));
  EqmProlongationAdd(p, level->coarse, level->x);
  PetscCall(UpdateGhosts(level));
  EqmSweepBackward(&level->sweeps, b, level->x, level->r);
  PetscFunctionReturn(0);
}

static PetscErrorCode Precondition(void *context, const PetscReal *b, PetscReal *x)
{
  EqmSharedCycle cycle = context;

  PetscFunctionBegin;
  PetscCall(Descend(cycle, 0, b));
  PetscCall(PetscArraycpy(x, cycle->level[0].x, 2 * cycle->finest.num_rows));
  PetscFunctionReturn(0);
}

static PetscErrorCode Multiply(void *context, const PetscReal *x, PetscReal *y)
{
  EqmSharedCycle cycle = context;
  Level *const level = &cycle->level[0];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(level->x, x, 2 * cycle->finest.num_rows));
  PetscCall(UpdateGhosts(level));
  EqmBlockMatrixMultiply(&cycle->finest, level->x, y);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedCycleSolve(EqmSharedCycle cycle, PetscReal tolerance, PetscInt *iterations, PetscBool *success)
{
  EqmLevelSystem *const system = cycle->system;

  PetscFunctionBegin;
  PetscCall(EqmConjugateGradients(cycle->comm, 2 * cycle->finest.num_rows, Multiply, Precondition, cycle, system->right,
                                  system->solution, tolerance, iterations, success));
  PetscCall(EqmSharedUpdateGhosts(cycle->shared, 2, system->solution));
  PetscFunctionReturn(0);
}
