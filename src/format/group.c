/* The groups of cells, and the faces that they were cut from, among the fields that a writer gets. */
#include "format.h"
#include "mesh/fields.h"

#include <string.h>

static const EqmField *Find(const EqmField *fields, PetscInt num_fields, const char *name)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells && fields[f].width == 1 && !strcmp(fields[f].name, name)) return &fields[f];
  }
  return NULL;
}

const EqmField *EqmFieldGroup(const EqmField *fields, PetscInt num_fields)
{
  return Find(fields, num_fields, EQM_FIELD_GROUP);
}

const EqmField *EqmFieldPolygon(const EqmField *fields, PetscInt num_fields)
{
  return Find(fields, num_fields, EQM_FIELD_POLYGON);
}

int EqmGroupOf(PetscReal number)
{
  return number > -2147483648.0 && number < 2147483648.0 ? (int)number : 0;
}
