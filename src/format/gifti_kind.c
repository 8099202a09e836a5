/* What a surface is to readers of GIFTI. */
#include "gifti.h"
#include "metadata.h"

#include <stdio.h>
#include <string.h>

const char *EqmGiftiGeometricType(const EqmSerialMesh *mesh, char *value, size_t length)
{
  PetscReal least = PETSC_MAX_REAL, most = 0.0;
  PetscBool flat = PETSC_TRUE;

  for (size_t i = 0; i < 3 * (size_t)mesh->num_cells; ++i) {
    const PetscReal *const x = mesh->vertices + 3 * (size_t)mesh->cells[i];
    const PetscReal squared = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];

    least = PetscMin(least, squared);
    most = PetscMax(most, squared);
    if (x[2] != mesh->vertices[3 * (size_t)mesh->cells[0] + 2]) flat = PETSC_FALSE;
  }
  if (flat) return "Flat";
  if (most > 0.0 && most - least <= 1e-3 * most) return "Spherical";
  if (!EqmMetadataGet(mesh->metadata, "GeometricType", value, length) || !strcmp(value, "Spherical") ||
      !strcmp(value, "Flat"))
    return "Anatomical";
  return value;
}

PetscBool EqmGiftiStructure(const EqmSerialMesh *mesh, const char *path, char *value, size_t length)
{
  const char *const slash = strrchr(path, '/'), *const name = slash ? slash + 1 : path;

  if (EqmMetadataGet(mesh->metadata, "AnatomicalStructurePrimary", value, length)) return PETSC_TRUE;
  if (!strncmp(name, "lh.", 3) || strstr(name, ".L.") || strstr(name, "hemi-L")) {
    snprintf(value, length, "CortexLeft");
  } else if (!strncmp(name, "rh.", 3) || strstr(name, ".R.") || strstr(name, "hemi-R")) {
    snprintf(value, length, "CortexRight");
  }
  return value[0] ? PETSC_TRUE : PETSC_FALSE;
}
