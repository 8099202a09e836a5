/* Conjugate gradients with multigrid on a hierarchy of meshes (src/hierarchy): coarse motions of the map are
   interpolated in its image, which aggregation of the matrix's entries cannot see (docs/methods.md, Cascade). For
   surfaces with one or two unknowns per vertex. The first rank has the levels; the others send their cells' matrices
   and right-hand sides. */
#include "linalg/onlevels.h"
#include "linalg/levelcells.h"
#include "linalg/levelrows.h"
#include "base/quiet.h"
#include "base/rows.h"
#include "mesh/mesh_private.h"

typedef struct {
  EqmHierarchy hierarchy;
  EqmCascadeTarget target;
  PetscSF vertices; /* roots: owned vertices; leaves: the finest level's */
  EqmLevelCells cells;
  PetscInt dim;   /* of places; 0 before there are any */
  PetscInt below; /* coarser levels that cycles have */
  EqmLevelMap map[EQM_MOST_LEVELS];
  EqmProlongation prolongation[EQM_MOST_LEVELS];
  PetscBool has_prolongations;
  PetscReal *frame;
  EqmLevelSystem system;
  EqmCycle cycle;
  PetscReal *owned; /* two per owned vertex */
} OnLevels;

/* What the first rank does while the others wait. Collective. */
static PetscErrorCode OnFirstRank(EqmLinear linear, PetscErrorCode (*work)(EqmLinear, void *), void *context)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  if (linear->mesh->rank == 0) code = work(linear, context);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmAgree(linear->mesh->comm, code, message));
  PetscFunctionReturn(0);
}

/* ---- places, and the prolongations that belong to them */

static PetscErrorCode DestroyProlongations(OnLevels *on)
{
  PetscFunctionBegin;
  PetscCall(EqmCycleDestroy(&on->cycle));
  for (PetscInt k = 0; k < on->below && on->has_prolongations; k++)
    PetscCall(EqmProlongationDestroy(&on->prolongation[k]));
  on->has_prolongations = PETSC_FALSE;
  PetscFunctionReturn(0);
}

/* Maps of all levels, at the first places: where vertices may move does not change. */
static PetscErrorCode CreateMaps(OnLevels *on)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k <= on->below; k++)
    PetscCall(EqmLevelMapCreate(&on->hierarchy->level[k], on->target, &on->map[k]));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakeProlongations(EqmLinear linear, void *context)
{
  OnLevels *const on = linear->data;

  PetscFunctionBegin;
  (void)context;
  PetscCall(DestroyProlongations(on));
  PetscCall(EqmLevelMapSetMotions(&on->map[0], on->target));
  for (PetscInt k = 0; k < on->below; k++) {
    PetscCall(EqmLevelMapRestrict(&on->map[k], &on->map[k + 1]));
    PetscCall(EqmProlongationCreate(&on->map[k], &on->map[k + 1], &on->prolongation[k]));
  }
  on->has_prolongations = PETSC_TRUE;
  PetscCall(EqmCycleCreate(&on->system.matrix, on->below, on->prolongation, &on->cycle));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetImage(EqmLinear linear, PetscInt dim, const PetscReal *x, const PetscReal *frame)
{
  OnLevels *const on = linear->data;

  PetscFunctionBegin;
  if (linear->mesh->rank == 0 && on->dim == 0) {
    PetscCall(CreateMaps(on));
    if (frame) PetscCall(PetscMalloc1(2 * dim * on->map[0].level->num_vertices, &on->frame));
    on->map[0].frame = on->frame;
  }
  on->dim = dim;
  PetscCall(EqmRowsToLeaves(on->vertices, dim, x, on->map[0].x));
  if (frame) PetscCall(EqmRowsToLeaves(on->vertices, 2 * dim, frame, on->frame));
  PetscCall(OnFirstRank(linear, MakeProlongations, NULL));
  PetscFunctionReturn(0);
}

/* ---- the matrix */

/* Matrices of all levels, from the cells'. */
static PetscErrorCode MakeCycle(EqmLinear linear, void *context)
{
  OnLevels *const on = linear->data;
  PetscBool *const success = context;

  PetscFunctionBegin;
  PetscCall(EqmLevelCellsAssemble(linear, &on->cells, &on->system, success));
  if (*success) PetscCall(EqmCycleFill(on->cycle, success));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  OnLevels *const on = linear->data;

  PetscFunctionBegin;
  PetscCheck(on->dim > 0, linear->mesh->comm, PETSC_ERR_ARG_WRONGSTATE, "no places of the map are known yet");
  PetscCall(EqmLevelCellsSend(linear, &on->cells));
  PetscCall(OnFirstRank(linear, MakeCycle, success));
  PetscCallMPI(MPI_Bcast(success, 1, MPIU_BOOL, 0, linear->mesh->comm));
  PetscFunctionReturn(0);
}

/* ---- solutions */

typedef struct {
  PetscInt iterations;
  PetscInt success;
} Outcome;

static PetscErrorCode Iterate(EqmLinear linear, void *context)
{
  OnLevels *const on = linear->data;
  Outcome *const outcome = context;
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(EqmCycleSolve(on->cycle, on->system.right, on->system.solution, linear->tolerance, &outcome->iterations,
                          &success));
  outcome->success = success;
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  OnLevels *const on = linear->data;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  for (PetscInt k = 0; k < num_rhs; k++) {
    Outcome outcome = {0, 0};
    EqmUnknownsSpread(&linear->unknowns, linear->mesh->num_owned, b + (size_t)k * linear->num_owned, on->owned);
    PetscCall(EqmRowsToLeaves(on->vertices, 2, on->owned, on->system.right));
    PetscCall(OnFirstRank(linear, Iterate, &outcome));
    PetscCallMPI(MPI_Bcast(&outcome, 2, MPIU_INT, 0, linear->mesh->comm));
    work->cg_iterations += outcome.iterations;
    if (!outcome.success) *success = PETSC_FALSE;
    PetscCall(EqmRowsToRoots(on->vertices, 2, on->system.solution, on->owned));
    EqmUnknownsCollect(&linear->unknowns, linear->mesh->num_owned, on->owned, x + (size_t)k * linear->num_owned);
  }
  PetscFunctionReturn(0);
}

/* ---- life */

static PetscErrorCode Destroy(EqmLinear linear)
{
  OnLevels *const on = linear->data;

  PetscFunctionBegin;
  PetscCall(DestroyProlongations(on));
  if (linear->mesh->rank == 0) {
    for (PetscInt k = 0; k <= on->below && on->dim > 0; k++) PetscCall(EqmLevelMapDestroy(&on->map[k]));
    PetscCall(EqmLevelSystemDestroy(&on->system));
  }
  PetscCall(PetscSFDestroy(&on->vertices));
  PetscCall(EqmLevelCellsDestroy(&on->cells));
  PetscCall(PetscFree(on->frame));
  PetscCall(PetscFree(on->owned));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

/* The finest level's pattern, and how many coarser ones there are down to one that is factored. */
static PetscErrorCode MakeSystem(EqmLinear linear, void *context)
{
  OnLevels *const on = linear->data;
  const EqmHierarchyLevel *const level = on->hierarchy->level;

  PetscFunctionBegin;
  while (on->below + 1 < on->hierarchy->num_levels && level[on->below].num_vertices > EQM_CYCLE_BOTTOM) on->below++;
  PetscCall(EqmLevelSystemCreate(&level[0], context, &on->system));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmLinear linear)
{
  OnLevels *const on = linear->data;
  const EqmMesh mesh = linear->mesh;
  const PetscBool first = (PetscBool)(mesh->rank == 0);
  const PetscInt n = first ? mesh->num_vertices : 0, m = first ? mesh->num_cells : 0;
  unsigned char *count;

  PetscFunctionBegin;
  PetscCall(EqmRowsCreateSF(mesh->comm, mesh->num_owned, n, on->hierarchy->order, &on->vertices));
  PetscCall(EqmLevelCellsCreate(mesh, m, on->hierarchy->cell_order, &on->cells));
  PetscCall(PetscMalloc1(2 * mesh->num_owned, &on->owned));
  PetscCall(PetscMalloc1(n, &count));
  PetscCall(EqmFetchRows(mesh->comm, mesh->num_owned, n, on->hierarchy->order, MPI_UNSIGNED_CHAR, 1,
                         linear->unknowns.count, count));
  PetscCall(OnFirstRank(linear, MakeSystem, count));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearCreateOnLevels(EqmMesh mesh, const EqmUnknowns *unknowns, EqmHierarchy hierarchy,
                                       EqmCascadeTarget target, EqmLinear *out)
{
  EqmLinear linear;
  OnLevels *on;

  PetscFunctionBegin;
  PetscCall(EqmLinearBegin(mesh, unknowns, EQM_MATRIX_COUPLED, &linear));
  PetscCall(PetscNew(&on));
  on->hierarchy = hierarchy;
  on->target = target;
  linear->kind = EQM_SOLVER_HIERARCHY;
  linear->data = on;
  linear->factor = Factor;
  linear->set_image = SetImage;
  linear->solve = Solve;
  linear->destroy = Destroy;
  PetscCall(SetUp(linear));
  *out = linear;
  PetscFunctionReturn(0);
}
