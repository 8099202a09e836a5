/* What a command adds to a result beyond the map: arrays for the result file, figures for it and for the summary. */
#include <equimap/map.h>

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

static PetscErrorCode AddFigure(EqmMap map, const char *key, EqmMapFigure **figure)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(EqmMapFigure) * (size_t)(map->num_figures + 1), &map->figures));
  *figure = &map->figures[map->num_figures++];
  PetscCall(PetscMemzero(*figure, sizeof(**figure)));
  PetscCall(PetscStrncpy((*figure)->key, key, sizeof((*figure)->key)));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddFigure(EqmMap map, const char *key, PetscReal value)
{
  EqmMapFigure *figure;

  PetscFunctionBegin;
  PetscCall(AddFigure(map, key, &figure));
  figure->value = value;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapAddText(EqmMap map, const char *key, const char *text)
{
  EqmMapFigure *figure;

  PetscFunctionBegin;
  PetscCall(AddFigure(map, key, &figure));
  figure->is_text = PETSC_TRUE;
  PetscCall(PetscStrncpy(figure->text, text, sizeof(figure->text)));
  PetscFunctionReturn(0);
}

/* Free all of them. Not collective. */
PetscErrorCode EqmMapDropExtras(EqmMap map)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < map->num_arrays; k++) {
    PetscCall(PetscFree(map->arrays[k].reals));
    PetscCall(PetscFree(map->arrays[k].integers));
  }
  PetscCall(PetscFree(map->arrays));
  PetscCall(PetscFree(map->figures));
  map->num_arrays = map->num_figures = 0;
  PetscFunctionReturn(0);
}
