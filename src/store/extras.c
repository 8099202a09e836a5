/* What a command adds to a result beyond the map: arrays for the result file, figures for it and for the summary. */
#include "store/map_private.h"
#include "store/store.h"

static PetscErrorCode AddArray(EqmMap map, const char *path, PetscInt total, PetscInt start, PetscInt count,
                               PetscInt width, EqmMapArray **array)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(EqmMapArray) * (size_t)(map->num_arrays + 1), &map->arrays));
  *array = &map->arrays[map->num_arrays++];
  **array = (EqmMapArray){.total = total, .start = start, .count = count, .width = width};
  PetscCall(PetscStrncpy((*array)->path, path, sizeof((*array)->path)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddReals(EqmMap map, const char *path, PetscInt total, PetscInt start, PetscInt count,
                              PetscInt width, PetscReal *values)
{
  EqmMapArray *array;

  PetscFunctionBegin;
  PetscCall(AddArray(map, path, total, start, count, width, &array));
  array->reals = values;
  array->is_real = PETSC_TRUE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddIntegers(EqmMap map, const char *path, PetscInt total, PetscInt start, PetscInt count,
                                 PetscInt width, PetscInt64 *values)
{
  EqmMapArray *array;

  PetscFunctionBegin;
  PetscCall(AddArray(map, path, total, start, count, width, &array));
  array->integers = values;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddPrepared(EqmMap map, const char *step, PetscInt64 count, const char *what)
{
  EqmPreparedFigure *prepared;

  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(EqmPreparedFigure) * (size_t)(map->num_prepared + 1), &map->prepared));
  prepared = &map->prepared[map->num_prepared++];
  prepared->count = count;
  PetscCall(PetscStrncpy(prepared->step, step, sizeof(prepared->step)));
  PetscCall(PetscStrncpy(prepared->what, what, sizeof(prepared->what)));
  PetscFunctionReturn(0);
}

static PetscErrorCode AddFigure(EqmMap map, const char *key, EqmFigureKind kind, EqmMapFigure **figure)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(EqmMapFigure) * (size_t)(map->num_figures + 1), &map->figures));
  *figure = &map->figures[map->num_figures++];
  PetscCall(PetscMemzero(*figure, sizeof(**figure)));
  PetscCall(PetscStrncpy((*figure)->key, key, sizeof((*figure)->key)));
  (*figure)->kind = kind;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddFigure(EqmMap map, const char *key, PetscReal value)
{
  EqmMapFigure *figure;

  PetscFunctionBegin;
  PetscCall(AddFigure(map, key, EQM_FIGURE_REAL, &figure));
  figure->real = value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddCount(EqmMap map, const char *key, PetscInt64 value)
{
  EqmMapFigure *figure;

  PetscFunctionBegin;
  PetscCall(AddFigure(map, key, EQM_FIGURE_COUNT, &figure));
  figure->count = value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddText(EqmMap map, const char *key, const char *text)
{
  EqmMapFigure *figure;

  PetscFunctionBegin;
  PetscCall(AddFigure(map, key, EQM_FIGURE_TEXT, &figure));
  PetscCall(PetscStrncpy(figure->text, text, sizeof(figure->text)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapResetExtras(EqmMap map)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < map->num_arrays; k++) {
    PetscCall(PetscFree(map->arrays[k].reals));
    PetscCall(PetscFree(map->arrays[k].integers));
  }
  PetscCall(PetscFree(map->arrays));
  PetscCall(PetscFree(map->figures));
  map->num_arrays = map->num_figures = 0;
  PetscCall(PetscFree(map->prepared));
  PetscFunctionReturn(0);
}
