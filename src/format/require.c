/* What a format cannot hold is refused before anything is written. */
#include "format.h"

#include <stdio.h>

/* EqmRequireSmall - refuse a mesh that a format with 32-bit numbers cannot count. Not collective. Errors: EQM_ERR_USAGE
   (quiet, reason in `error`). */
PetscErrorCode EqmRequireSmall(const EqmSerialMesh *mesh, const char *format, char *error, size_t length)
{
  if ((PetscInt64)mesh->num_vertices < INT32_MAX && (PetscInt64)mesh->num_cells < INT32_MAX) return 0;
  snprintf(error, length, "%s files cannot count that many vertices or cells; choose .h5", format);
  return EQM_ERR_USAGE;
}

/* EqmRequireTriangles - refuse a mesh that a surface format cannot hold. Not collective. Errors: EQM_ERR_USAGE (quiet,
   reason in `error`). */
PetscErrorCode EqmRequireTriangles(const EqmSerialMesh *mesh, const char *format, char *error, size_t length)
{
  if (mesh->cell_size == 3) return EqmRequireSmall(mesh, format, error, length);
  snprintf(error, length, "%s files cannot hold tetrahedra; choose .h5, .vtu, .msh or .mesh", format);
  return EQM_ERR_USAGE;
}
