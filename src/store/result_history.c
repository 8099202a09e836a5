/* The history in a result file: /history/..., an array per column. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/columns.h"
#include "store/store.h"
#include "h5/h5.h"

static void Path(const char *name, char path[64])
{
  (void)snprintf(path, 64, "/history/%s", name);
}

PetscErrorCode EqmResultDeclareHistory(EqmH5 h5, EqmMap map)
{
  char path[64];

  PetscFunctionBegin;
  PetscCall(EqmH5DeclareIntegers(h5, "/history/iteration", map->num_history, 0));
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS; k++) {
    Path(EqmHistoryColumns[k].name, path);
    PetscCall(EqmHistoryColumns[k].is_count ? EqmH5DeclareIntegers(h5, path, map->num_history, 0)
                                            : EqmH5DeclareReals(h5, path, map->num_history, 0));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteColumn(EqmH5 h5, EqmMap map, const EqmHistoryColumn *column, EqmSlab slab, void *values)
{
  char path[64];

  PetscFunctionBegin;
  Path(column->name, path);
  for (PetscInt i = 0; i < map->num_history; i++) {
    const void *const entry = EqmHistoryEntry(&map->history[i], column);
    if (column->is_count)
      ((PetscInt64 *)values)[i] = *(const PetscInt64 *)entry;
    else
      ((PetscReal *)values)[i] = *(const PetscReal *)entry;
  }
  PetscCall(column->is_count ? EqmH5WriteIntegers(h5, path, slab, values) : EqmH5WriteReals(h5, path, slab, values));
  PetscFunctionReturn(0);
}

/* The history is the same everywhere: rank 0 writes it. */
PetscErrorCode EqmResultWriteHistory(EqmH5 h5, EqmMap map)
{
  const EqmSlab slab = {map->num_history, 0, h5->rank == 0 ? map->num_history : 0, 0};
  PetscErrorCode error;
  PetscReal *reals;
  PetscInt64 *counts;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(map->num_history, &reals, map->num_history, &counts));
  for (PetscInt i = 0; i < map->num_history; i++) counts[i] = map->history[i].iteration;
  error = EqmH5WriteIntegers(h5, "/history/iteration", slab, counts);
  for (int k = 0; k < EQM_NUM_HISTORY_COLUMNS && !error; k++) {
    const EqmHistoryColumn *const column = &EqmHistoryColumns[k];
    error = WriteColumn(h5, map, column, slab, column->is_count ? (void *)counts : (void *)reals);
  }
  PetscCall(PetscFree2(reals, counts));
  PetscCall(error);
  PetscFunctionReturn(0);
}
