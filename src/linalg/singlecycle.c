#include "linalg/singlecycle.h"
#include "linalg/singlesweeps.h"

typedef struct {
  EqmSingleRows rows, from_below,
      to_below; /* the matrix, the prolongation from the next coarser level, its transpose */
  EqmSingleSweeps sweeps;
  float *b, *x, *r, *old; /* x and old with ghosts, also of the finer level's prolongation; r with those of to_below */
} Level;

struct _p_EqmSingleCycle {
  MPI_Comm comm;
  PetscInt num_levels;    /* above the coarsest; the finest first */
  PetscBool fixed_finite; /* are the prolongations' entries? */
  Level *level;
  KSP bottom; /* the aggregation's solver of the coarsest */
  Vec bottom_b, bottom_x;
  float *coarse_b, *coarse_x; /* there; coarse_x with ghosts */
};

/* ---- patterns */

/* Are there levels of blocks of three? */
static PetscErrorCode IsFit(PC pc, PetscBool *fit)
{
  PetscInt num_levels;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCGAMG, fit));
  if (!*fit) PetscFunctionReturn(0);
  PetscCall(PCMGGetLevels(pc, &num_levels));
  *fit = (PetscBool)(num_levels > 1);
  for (PetscInt k = 1; k < num_levels && *fit; k++) {
    Mat prolongation;
    PetscCall(PCMGGetInterpolation(pc, k, &prolongation));
    PetscCall(EqmSingleRowsFit(prolongation, fit));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Allocate(PetscInt num_rows, float **x)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(EQM_SINGLE_WIDTH * num_rows, x));
  PetscFunctionReturn(0);
}

/* Level k of PETSc's, which count from the coarsest. Renewals may put another matrix in the place of the old one. */
static PetscErrorCode GetMatrix(PC pc, PetscInt k, Mat *matrix)
{
  KSP smoother;

  PetscFunctionBegin;
  PetscCall(PCMGGetSmoother(pc, k, &smoother));
  PetscCall(KSPGetOperators(smoother, NULL, matrix));
  PetscFunctionReturn(0);
}

/* Rows with their entries, which stay. */
static PetscErrorCode CreateFixed(Mat matrix, PetscBool *finite, EqmSingleRows *rows)
{
  PetscBool mine;

  PetscFunctionBegin;
  PetscCall(EqmSingleRowsCreate(matrix, PETSC_FALSE, rows));
  PetscCall(EqmSingleRowsFill(matrix, rows, &mine));
  *finite = (PetscBool)(*finite && mine);
  PetscFunctionReturn(0);
}

/* Functions that are constant on aggregates cannot have as little energy as smooth ones: corrections by them are too
   short (D. Braess, Computing 55, 1995). Times 1.4 to 1.6 solids with 59,000 and 250,000 vertices need as few cycles as
   with smoothed aggregates, without 1.4 to 1.6 times as many. The cycle stays symmetric and definite with any factor.
 */
static PetscErrorCode StretchCorrections(MPI_Comm comm, EqmSingleRows *from_below)
{
  const float factor = 1.5F;
  const PetscBool mine = (PetscBool)(from_below->start[from_below->num_rows] <= from_below->num_rows);
  PetscBool constant;

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(&mine, &constant, 1, MPIU_BOOL, MPI_LAND, comm));
  if (constant) EqmSingleRowsScale(factor, from_below);
  PetscFunctionReturn(0);
}

/* `ghosts`: those that x is going to have at most for the level above; replaced by those of the level below. */
static PetscErrorCode CreateLevel(PC pc, PetscInt k, PetscInt *ghosts, PetscBool *finite, Level *level)
{
  Mat matrix, prolongation, transpose;

  PetscFunctionBegin;
  PetscCall(GetMatrix(pc, k, &matrix));
  PetscCall(PCMGGetInterpolation(pc, k, &prolongation));
  PetscCall(EqmSingleRowsCreate(matrix, PETSC_TRUE, &level->rows));
  PetscCall(EqmSingleSweepsCreate(&level->rows, &level->sweeps));
  PetscCall(CreateFixed(prolongation, finite, &level->from_below));
  PetscCall(StretchCorrections(PetscObjectComm((PetscObject)pc), &level->from_below));
  PetscCall(MatTranspose(prolongation, MAT_INITIAL_MATRIX, &transpose));
  PetscCall(CreateFixed(transpose, finite, &level->to_below));
  PetscCall(MatDestroy(&transpose));
  const PetscInt n = level->rows.num_rows, most = PetscMax(*ghosts, level->rows.num_ghosts);
  PetscCall(Allocate(n, &level->b));
  PetscCall(Allocate(n + most, &level->x));
  PetscCall(Allocate(n + level->rows.num_ghosts, &level->old));
  PetscCall(Allocate(n + level->to_below.num_ghosts, &level->r));
  *ghosts = level->from_below.num_ghosts;
  PetscFunctionReturn(0);
}

static PetscErrorCode Create(PC pc, EqmSingleCycle *out)
{
  PetscInt num_levels, ghosts = 0;
  EqmSingleCycle cycle;
  Mat coarsest;

  PetscFunctionBegin;
  PetscCall(PCMGGetLevels(pc, &num_levels));
  PetscCall(PetscNew(&cycle));
  cycle->comm = PetscObjectComm((PetscObject)pc);
  cycle->num_levels = num_levels - 1;
  cycle->fixed_finite = PETSC_TRUE;
  PetscCall(PetscCalloc1(cycle->num_levels, &cycle->level));
  for (PetscInt j = 0; j < cycle->num_levels; j++)
    PetscCall(CreateLevel(pc, num_levels - 1 - j, &ghosts, &cycle->fixed_finite, &cycle->level[j]));
  PetscCall(PCMGGetCoarseSolve(pc, &cycle->bottom));
  PetscCall(KSPGetOperators(cycle->bottom, NULL, &coarsest));
  PetscCall(MatCreateVecs(coarsest, &cycle->bottom_x, &cycle->bottom_b));
  const PetscInt n = cycle->level[cycle->num_levels - 1].to_below.num_rows;
  PetscCall(Allocate(n, &cycle->coarse_b));
  PetscCall(Allocate(n + ghosts, &cycle->coarse_x));
  *out = cycle;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleCycleDestroy(EqmSingleCycle *out)
{
  EqmSingleCycle cycle = *out;

  PetscFunctionBegin;
  if (!cycle) PetscFunctionReturn(0);
  for (PetscInt j = 0; j < cycle->num_levels; j++) {
    Level *const level = &cycle->level[j];
    PetscCall(EqmSingleSweepsDestroy(&level->sweeps));
    PetscCall(EqmSingleRowsDestroy(&level->rows));
    PetscCall(EqmSingleRowsDestroy(&level->from_below));
    PetscCall(EqmSingleRowsDestroy(&level->to_below));
    PetscCall(PetscFree(level->b));
    PetscCall(PetscFree(level->x));
    PetscCall(PetscFree(level->old));
    PetscCall(PetscFree(level->r));
  }
  PetscCall(VecDestroy(&cycle->bottom_b));
  PetscCall(VecDestroy(&cycle->bottom_x));
  PetscCall(PetscFree(cycle->coarse_b));
  PetscCall(PetscFree(cycle->coarse_x));
  PetscCall(PetscFree(cycle->level));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

/* ---- entries */

/* `success` is false on all ranks where single precision does not reach. */
static PetscErrorCode FillAll(PC pc, EqmSingleCycle cycle, PetscBool *success)
{
  PetscBool all = cycle->fixed_finite;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < cycle->num_levels; j++) {
    Level *const level = &cycle->level[j];
    PetscBool entries, inverses;
    Mat matrix;
    PetscCall(GetMatrix(pc, cycle->num_levels - j, &matrix));
    PetscCall(EqmSingleRowsFill(matrix, &level->rows, &entries));
    EqmSingleSweepsFill(&level->sweeps, &inverses);
    all = (PetscBool)(all && entries && inverses);
  }
  PetscCall(MPIU_Allreduce(&all, success, 1, MPIU_BOOL, MPI_LAND, cycle->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleCycleRenew(PC pc, EqmSingleCycle *cycle)
{
  PetscBool fit, success;

  PetscFunctionBegin;
  PetscCall(IsFit(pc, &fit));
  if (!fit) PetscFunctionReturn(0);
  if (!*cycle) PetscCall(Create(pc, cycle));
  PetscCall(FillAll(pc, *cycle, &success));
  if (!success) PetscCall(EqmSingleCycleDestroy(cycle));
  PetscFunctionReturn(0);
}

/* ---- application */

static PetscErrorCode FromVec(Vec v, float *x)
{
  const PetscScalar *array;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(v, &n));
  PetscCall(VecGetArrayRead(v, &array));
#pragma omp parallel for schedule(static)
  for (PetscInt i = 0; i < n / 3; i++) {
    for (PetscInt k = 0; k < 3; k++) x[EQM_SINGLE_WIDTH * i + k] = (float)array[3 * i + k];
  }
  PetscCall(VecRestoreArrayRead(v, &array));
  PetscFunctionReturn(0);
}

static PetscErrorCode ToVec(const float *x, Vec v)
{
  PetscScalar *array;
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(v, &n));
  PetscCall(VecGetArrayWrite(v, &array));
#pragma omp parallel for schedule(static)
  for (PetscInt i = 0; i < n / 3; i++) {
    for (PetscInt k = 0; k < 3; k++) array[3 * i + k] = (PetscScalar)x[EQM_SINGLE_WIDTH * i + k];
  }
  PetscCall(VecRestoreArrayWrite(v, &array));
  PetscFunctionReturn(0);
}

static PetscErrorCode ApplyBottom(EqmSingleCycle cycle)
{
  PetscFunctionBegin;
  PetscCall(ToVec(cycle->coarse_b, cycle->bottom_b));
  PetscCall(KSPSolve(cycle->bottom, cycle->bottom_b, cycle->bottom_x));
  PetscCall(FromVec(cycle->bottom_x, cycle->coarse_x));
  PetscFunctionReturn(0);
}

/* x = B b on level j and those below. */
static PetscErrorCode Descend(EqmSingleCycle cycle, PetscInt j)
{
  Level *const level = &cycle->level[j];
  const PetscBool last = (PetscBool)(j + 1 == cycle->num_levels);
  float *const below_b = last ? cycle->coarse_b : level[1].b, *const below_x = last ? cycle->coarse_x : level[1].x;

  PetscFunctionBegin;
  EqmSingleSweepBefore(&level->sweeps, level->b, level->x, level->r);
  PetscCall(EqmSingleRowsUpdateGhosts(&level->rows, level->x));
  EqmSingleSweepResidual(&level->sweeps, level->b, level->x, level->r, level->r);
  PetscCall(EqmSingleRowsUpdateGhosts(&level->to_below, level->r));
  EqmSingleRowsMultiply(&level->to_below, level->r, PETSC_FALSE, below_b);
  if (last)
    PetscCall(ApplyBottom(cycle));
  else
    PetscCall(Descend(cycle, j + 1));
  PetscCall(EqmSingleRowsUpdateGhosts(&level->from_below, below_x));
  EqmSingleRowsMultiply(&level->from_below, below_x, PETSC_TRUE, level->x);
  PetscCall(EqmSingleRowsUpdateGhosts(&level->rows, level->x));
  EqmSingleSweepAfter(&level->sweeps, level->b, level->x, level->old, level->r);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSingleCycleApply(EqmSingleCycle cycle, Vec b, Vec x)
{
  PetscFunctionBegin;
  PetscCall(FromVec(b, cycle->level[0].b));
  PetscCall(Descend(cycle, 0));
  PetscCall(ToVec(cycle->level[0].x, x));
  PetscFunctionReturn(0);
}
