#include "hierarchy/sharedbottom.h"
#include "base/quiet.h"

struct _p_EqmSharedBottom {
  EqmHierarchy hierarchy;
  PetscInt num; /* prolongations */
  EqmProlongation prolongation[EQM_MOST_LEVELS];
  EqmCycle cycle; /* NULL but on the first rank */
  PetscReal *x;   /* of its finest level */
};

/* What the first rank does. */
typedef PetscErrorCode (*Work)(EqmSharedBottom bottom, void *context);

/* The others wait for it. Collective. */
static PetscErrorCode OnFirstRank(EqmSharedBottom bottom, Work work, void *context)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(EqmKeepMessage, message));
  if (bottom->hierarchy->rank == 0) code = work(bottom, context);
  PetscCall(PetscPopErrorHandler());
  PetscCall(EqmAgree(bottom->hierarchy->comm, code, message));
  PetscFunctionReturn(0);
}

typedef struct {
  EqmCascadeTarget target;
  PetscInt most;
  const EqmBlockMatrix *matrix;
  const PetscReal *x;
} Given;

static PetscErrorCode MakeCycle(EqmSharedBottom bottom, void *context)
{
  const Given *const given = context;
  const EqmHierarchyLevel *const level = bottom->hierarchy->level;
  EqmLevelMap map[EQM_MOST_LEVELS];

  PetscFunctionBegin;
  while (bottom->num + 1 < bottom->hierarchy->num_levels && level[bottom->num].num_vertices > given->most)
    bottom->num++;
  for (PetscInt k = 0; k <= bottom->num; k++) {
    PetscCall(EqmLevelMapCreate(&level[k], given->target, &map[k]));
    if (k == 0) {
      PetscCall(PetscArraycpy(map[0].x, given->x, map[0].dim * level[0].num_vertices));
      PetscCall(EqmLevelMapSetMotions(&map[0], given->target));
    } else {
      PetscCall(EqmLevelMapRestrict(&map[k - 1], &map[k]));
      PetscCall(EqmProlongationCreate(&map[k - 1], &map[k], &bottom->prolongation[k - 1]));
    }
  }
  for (PetscInt k = 0; k <= bottom->num; k++) PetscCall(EqmLevelMapDestroy(&map[k]));
  PetscCall(EqmCycleCreate(given->matrix, bottom->num, bottom->prolongation, &bottom->cycle));
  PetscCall(PetscMalloc1(2 * given->matrix->num_rows, &bottom->x));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedBottomCreate(EqmShared shared, EqmCascadeTarget target, const EqmLevelMap *last, PetscInt most,
                                     const EqmBlockMatrix *matrix, EqmSharedBottom *out)
{
  const EqmHierarchy hierarchy = shared->coarser;
  Given given = {.target = target, .most = most, .matrix = matrix};
  EqmSharedBottom bottom;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(PetscNew(&bottom));
  bottom->hierarchy = hierarchy;
  PetscCall(PetscMalloc1(last->dim * hierarchy->level[0].num_vertices, &x));
  PetscCall(EqmHierarchyGather(hierarchy, last->dim, last->x, x));
  given.x = x;
  PetscCall(OnFirstRank(bottom, MakeCycle, &given));
  PetscCall(PetscFree(x));
  *out = bottom;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedBottomDestroy(EqmSharedBottom *out)
{
  EqmSharedBottom bottom = *out;

  PetscFunctionBegin;
  if (!bottom) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < bottom->num; k++) PetscCall(EqmProlongationDestroy(&bottom->prolongation[k]));
  PetscCall(EqmCycleDestroy(&bottom->cycle));
  PetscCall(PetscFree(bottom->x));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

static PetscErrorCode FillCycle(EqmSharedBottom bottom, void *context)
{
  PetscFunctionBegin;
  PetscCall(EqmCycleFill(bottom->cycle, context));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedBottomFill(EqmSharedBottom bottom, PetscBool *success)
{
  PetscFunctionBegin;
  PetscCall(OnFirstRank(bottom, FillCycle, success));
  PetscCallMPI(MPI_Bcast(success, 1, MPIU_BOOL, 0, bottom->hierarchy->comm));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSharedBottomApply(EqmSharedBottom bottom, const PetscReal *b, PetscReal **x)
{
  PetscFunctionBegin;
  *x = bottom->x;
  if (bottom->cycle) PetscCall(EqmCycleApply(bottom->cycle, b, bottom->x));
  PetscFunctionReturn(0);
}
