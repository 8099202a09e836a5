/* The groups of cells among the fields that a writer gets. */
#include "format.h"
#include "mesh/fields.h"

#include <string.h>

const EqmField *EqmFieldGroup(const EqmField *fields, PetscInt num_fields)
{
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells && fields[f].width == 1 && !strcmp(fields[f].name, EQM_FIELD_GROUP)) return &fields[f];
  }
  return NULL;
}

int EqmGroupOfCell(const EqmField *group, PetscInt cell)
{
  const PetscReal number = group ? group->values[cell] : 0.0;

  return number > -2147483648.0 && number < 2147483648.0 ? (int)number : 0;
}
