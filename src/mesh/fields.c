#include "mesh/fields.h"
#include "mesh/soup_private.h"
#include <string.h>

PetscErrorCode EqmMeshFieldsAdd(PetscInt *num_fields, EqmMeshField **fields, const EqmMeshField *kind, size_t rows,
                                PetscReal **values)
{
  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(EqmMeshField) * (size_t)(*num_fields + 1), fields));
  EqmMeshField *const field = &(*fields)[*num_fields];
  *field = *kind;
  PetscCall(PetscMalloc1(rows * (size_t)kind->width + 1, &field->values));
  *values = field->values;
  ++*num_fields;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshFieldsReset(PetscInt *num_fields, EqmMeshField **fields)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < *num_fields; ++f) PetscCall(PetscFree((*fields)[f].values));
  PetscCall(PetscFree(*fields));
  *num_fields = 0;
  PetscFunctionReturn(0);
}

const EqmMeshField *EqmMeshFieldsFind(PetscInt num_fields, const EqmMeshField *fields, const char *name,
                                      PetscBool on_cells)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells == on_cells && !strcmp(fields[f].name, name)) return &fields[f];
  }
  return NULL;
}

PetscBool EqmMeshFieldIsOfResult(const char *name)
{
  static const char *const names[] = {
      "ratio", "vertex_ratio", "quasi_conformal", "conformal_factor", "mapped", "map", "mesh", "surface", "u", "v"};

  for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); ++k) {
    if (!strcmp(name, names[k])) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscErrorCode EqmMeshFieldsTakeTexture(EqmSerialMesh *mesh)
{
  const EqmMeshField field = {EQM_FIELD_TEXTURE, PETSC_TRUE, 2 * mesh->cell_size, mesh->texture};

  PetscFunctionBegin;
  if (!mesh->texture) PetscFunctionReturn(0);
  PetscCall(PetscRealloc(sizeof(EqmMeshField) * (size_t)(mesh->num_fields + 1), &mesh->fields));
  mesh->fields[mesh->num_fields++] = field;
  mesh->texture = NULL;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshFieldsGiveTexture(EqmSerialMesh *mesh)
{
  const EqmMeshField *const found = EqmMeshFieldsFind(mesh->num_fields, mesh->fields, EQM_FIELD_TEXTURE, PETSC_TRUE);

  PetscFunctionBegin;
  if (!found || mesh->texture || found->width != 2 * mesh->cell_size) PetscFunctionReturn(0);
  mesh->texture = found->values;
  for (PetscInt f = (PetscInt)(found - mesh->fields); f + 1 < mesh->num_fields; ++f)
    mesh->fields[f] = mesh->fields[f + 1];
  if (--mesh->num_fields == 0) PetscCall(PetscFree(mesh->fields));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupGetFields(EqmSoup soup, PetscInt *num_fields, const EqmMeshField **fields)
{
  PetscFunctionBegin;
  *num_fields = soup->num_fields;
  *fields = soup->fields;
  PetscFunctionReturn(0);
}
