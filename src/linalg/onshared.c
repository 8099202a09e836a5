/* Conjugate gradients with multigrid on levels that all ranks share: what onlevels.c does on one rank. The rows of the
   finest level are on the ranks that have its pieces, which get their cells' matrices from those that have the cells.
 */
#include "linalg/onshared.h"
#include "linalg/levelcells.h"
#include "linalg/levelrows.h"
#include "base/rows.h"
#include "hierarchy/cycle.h"
#include "mesh/mesh_private.h"

typedef struct {
  EqmShared shared;
  const EqmSharedLevel *finest;
  EqmCascadeTarget target;
  EqmLevelCells cells;
  EqmLevelMap map; /* of the finest level; no dimension before there are places */
  PetscReal *frame;
  EqmLevelSystem system;
  EqmSharedCycle cycle;
  PetscReal *owned; /* two per owned vertex of the mesh */
} OnShared;

/* Where vertices may move does not change. */
static PetscErrorCode SetImage(EqmLinear linear, PetscInt dim, const PetscReal *x, const PetscReal *frame)
{
  OnShared *const on = linear->data;
  const EqmSharedLevel *const finest = on->finest;

  PetscFunctionBegin;
  if (on->map.dim == 0) {
    PetscCall(EqmSharedMapCreate(finest, on->target, x, &on->map));
    if (frame) PetscCall(PetscMalloc1(2 * dim * finest->num_owned, &on->frame));
    on->map.frame = on->frame;
  } else {
    PetscCall(EqmRowsToLeaves(finest->from_finer, dim, x, on->map.x));
    PetscCall(EqmSharedUpdateGhosts(finest, dim, on->map.x));
  }
  if (frame) PetscCall(EqmRowsToLeaves(finest->from_finer, 2 * dim, frame, on->frame));
  PetscCall(EqmSharedCycleDestroy(&on->cycle));
  PetscCall(EqmSharedCycleCreate(on->shared, 0, on->target, &on->map, EQM_CYCLE_BOTTOM, &on->system, &on->cycle));
  PetscFunctionReturn(0);
}

static PetscErrorCode Factor(EqmLinear linear, PetscBool *success)
{
  OnShared *const on = linear->data;

  PetscFunctionBegin;
  PetscCheck(on->cycle, linear->mesh->comm, PETSC_ERR_ARG_WRONGSTATE, "no places of the map are known yet");
  PetscCall(EqmLevelCellsSend(linear, &on->cells));
  PetscCall(EqmLevelCellsAssemble(linear, &on->cells, &on->system, success));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, linear->mesh->comm));
  if (*success) PetscCall(EqmSharedCycleFill(on->cycle, success));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x, PetscBool *success)
{
  OnShared *const on = linear->data;
  const PetscInt num_owned = linear->mesh->num_owned;
  EqmWork *work;

  PetscFunctionBegin;
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  for (PetscInt k = 0; k < num_rhs; k++) {
    PetscInt iterations;
    PetscBool solved;
    EqmUnknownsSpread(&linear->unknowns, num_owned, b + (size_t)k * linear->num_owned, on->owned);
    PetscCall(EqmRowsToLeaves(on->finest->from_finer, 2, on->owned, on->system.right));
    PetscCall(EqmSharedCycleSolve(on->cycle, linear->tolerance, &iterations, &solved));
    work->cg_iterations += iterations;
    if (!solved) *success = PETSC_FALSE;
    PetscCall(EqmRowsToRoots(on->finest->from_finer, 2, on->system.solution, on->owned));
    EqmUnknownsCollect(&linear->unknowns, num_owned, on->owned, x + (size_t)k * linear->num_owned);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Destroy(EqmLinear linear)
{
  OnShared *const on = linear->data;

  PetscFunctionBegin;
  PetscCall(EqmSharedCycleDestroy(&on->cycle));
  PetscCall(EqmLevelSystemDestroy(&on->system));
  PetscCall(EqmLevelMapDestroy(&on->map));
  PetscCall(EqmLevelCellsDestroy(&on->cells));
  PetscCall(PetscFree(on->frame));
  PetscCall(PetscFree(on->owned));
  PetscCall(PetscFree(linear->data));
  PetscFunctionReturn(0);
}

static PetscErrorCode SetUp(EqmLinear linear)
{
  OnShared *const on = linear->data;
  const EqmSharedLevel *const finest = on->finest;
  unsigned char *count;

  PetscFunctionBegin;
  PetscCall(EqmLevelCellsCreate(linear->mesh, finest->level.num_cells, finest->cell_order, &on->cells));
  PetscCall(PetscMalloc1(2 * linear->mesh->num_owned, &on->owned));
  PetscCall(PetscMalloc1(finest->level.num_vertices, &count));
  PetscCall(EqmRowsOfToLeaves(finest->from_finer, MPI_UNSIGNED_CHAR, 1, linear->unknowns.count, count));
  PetscCall(EqmRowsOfToLeaves(finest->halo, MPI_UNSIGNED_CHAR, 1, count, count + finest->num_owned));
  PetscCall(EqmLevelSystemCreate(&finest->level, count, &on->system));
  PetscCall(PetscFree(count));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearCreateOnShared(EqmMesh mesh, const EqmUnknowns *unknowns, EqmShared shared,
                                       EqmCascadeTarget target, EqmLinear *out)
{
  EqmLinear linear;
  OnShared *on;

  PetscFunctionBegin;
  PetscCall(EqmLinearBegin(mesh, unknowns, EQM_MATRIX_COUPLED, &linear));
  PetscCall(PetscNew(&on));
  on->shared = shared;
  on->finest = &shared->level[0];
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
