/* Fields of a mesh that is being made: what the file has per vertex and per cell beside it. */
#include "builder.h"
#include "mesh/fields.h"

#include <stdio.h>
#include <string.h>

enum { MOST_FIELDS = 256, MOST_COMPONENTS = 64 }; /* of one file; what is beyond is not kept */

/* EqmBuilderSetRow - the cells that are added from now on belong to this row of the file's cell fields. Not collective.
 */
void EqmBuilderSetRow(EqmBuilder *builder, PetscInt64 row)
{
  builder->row = row;
  builder->has_rows = PETSC_TRUE;
}

/* EqmBuilderSetGroup - the cells that are added from now on belong to the group of that number; 0: to none. Not
   collective. */
void EqmBuilderSetGroup(EqmBuilder *builder, PetscInt64 group)
{
  EqmBuilderSetRow(builder, group);
  builder->rows_are_groups = PETSC_TRUE;
}

/* EqmBuilderNoteLeft - of the file `what` is left out; said once. Not collective. */
void EqmBuilderNoteLeft(EqmBuilder *builder, const char *what)
{
  const size_t used = strlen(builder->left);

  if (strstr(builder->left, what)) return;
  snprintf(builder->left + used, sizeof(builder->left) - used, "%s%s", used ? ", " : "", what);
}

/* EqmBuilderAddField - announce a field; the caller fills in its values. Not collective.

   name - of name_length bytes, cut where it is too long; num_rows - for fields on vertices, as many as there will be;
   values - width * num_rows zeros, NULL if the field is not kept: one of that name is there, or it is too wide. Room in
   the file has been checked. */
PetscErrorCode EqmBuilderAddField(EqmBuilder *builder, const char *name, size_t name_length, PetscBool on_cells,
                                  PetscInt64 width, size_t num_rows, PetscReal **values)
{
  EqmRawField raw = {.field = {.on_cells = on_cells, .width = (PetscInt)width}, .num_rows = num_rows};

  *values = NULL;
  if (!name_length || width < 1 || width > MOST_COMPONENTS || builder->num_fields == MOST_FIELDS) return 0;
  memcpy(raw.field.name, name, PetscMin(name_length, sizeof(raw.field.name) - 1));
  for (PetscInt f = 0; f < builder->num_fields; ++f) {
    if (builder->fields[f].field.on_cells == on_cells && !strcmp(builder->fields[f].field.name, raw.field.name))
      return 0;
  }
  EqmTry(PetscRealloc(sizeof(EqmRawField) * (size_t)(builder->num_fields + 1), &builder->fields));
  EqmTry(PetscCalloc1((size_t)width * num_rows + 1, &raw.field.values));
  builder->fields[builder->num_fields++] = raw;
  *values = raw.field.values;
  return 0;
}

/* EqmBuilderDropField - forget the field that was announced last. Not collective. */
PetscErrorCode EqmBuilderDropField(EqmBuilder *builder)
{
  --builder->num_fields; /* apart, as PetscFree is a macro that names its argument twice */
  return PetscFree(builder->fields[builder->num_fields].field.values);
}

/* A field on cells has a row for each, that of the face which a triangle was cut from. */
static void CopyRows(const EqmRawField *raw, const EqmCellList *cells, PetscReal *values)
{
  const size_t width = (size_t)raw->field.width;

  for (size_t i = 0; i < width * cells->count; ++i) {
    const PetscInt64 row = cells->row[i / width];

    values[i] = row >= 0 && (size_t)row < raw->num_rows ? raw->field.values[width * (size_t)row + i % width] : 0.0;
  }
}

/* EqmBuilderHasGroups - are there cells of groups other than 0? Not collective. */
PetscBool EqmBuilderHasGroups(const EqmCellList *cells)
{
  for (size_t i = 0; cells->row && cells->num_rows == cells->count && i < cells->count; ++i) {
    if (cells->row[i] != 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The field "group". */
static PetscErrorCode AddGroups(const EqmCellList *cells, EqmSerialMesh *mesh)
{
  const EqmMeshField kind = {EQM_FIELD_GROUP, PETSC_TRUE, 1, NULL};
  PetscReal *values;

  EqmTry(EqmMeshFieldsAdd(&mesh->num_fields, &mesh->fields, &kind, cells->count, &values));
  for (size_t i = 0; i < cells->count; ++i) values[i] = (PetscReal)cells->row[i];
  return 0;
}

/* EqmBuilderTakeFields - hand the fields over to the mesh that was made of the vertices and of `cells`; those that do
   not fit it are dropped. Not collective. has_groups - where rows are groups: some cells have others than 0. */
PetscErrorCode EqmBuilderTakeFields(EqmBuilder *builder, EqmSerialMesh *mesh, const EqmCellList *cells,
                                    PetscBool has_groups)
{
  /* a part of a file may have rows and no cell */
  const PetscBool has_rows = builder->has_rows && cells->num_rows == cells->count ? PETSC_TRUE : PETSC_FALSE;
  PetscReal *values;

  if (builder->rows_are_groups) return has_groups ? AddGroups(cells, mesh) : 0;
  for (PetscInt f = 0; f < builder->num_fields; ++f) {
    const EqmRawField *const raw = &builder->fields[f];

    if (raw->field.on_cells ? !has_rows : raw->num_rows != (size_t)mesh->num_vertices) continue;
    EqmTry(EqmMeshFieldsAdd(&mesh->num_fields, &mesh->fields, &raw->field,
                            raw->field.on_cells ? cells->count : raw->num_rows, &values));
    if (raw->field.on_cells)
      CopyRows(raw, cells, values);
    else
      memcpy(values, raw->field.values, sizeof(PetscReal) * (size_t)raw->field.width * raw->num_rows);
  }
  return 0;
}
