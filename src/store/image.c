/* A map in mesh formats: the input's cells with every vertex at its image, or at its input position with its image as a
 * field.
 */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "store/store.h"
#include "format/format.h"
#include <string.h>

enum { MOST_FIELDS = 8 };

/* This rank's slabs. */
typedef struct {
  PetscReal *image;    /* 3 per vertex: where it is mapped to, with z = 0 for planar maps */
  PetscReal *plane[2]; /* of planar maps: u and v per vertex */
  EqmField fields[MOST_FIELDS];
  PetscInt num_fields;
} Slabs;

static void AddField(Slabs *slabs, const char *name, PetscBool on_cells, PetscInt width, const PetscReal *values)
{
  slabs->fields[slabs->num_fields++] = (EqmField){name, on_cells, width, values};
}

/* What every file has. */
static void AddRatios(EqmMap map, Slabs *slabs)
{
  AddField(slabs, "ratio", PETSC_TRUE, 1, map->cell_ratio);
  AddField(slabs, "vertex_ratio", PETSC_FALSE, 1, map->vertex_ratio);
  if (map->soup->cell_size == 4) return;
  AddField(slabs, "quasi_conformal", PETSC_TRUE, 1, map->quasi_conformal);
  AddField(slabs, "conformal_factor", PETSC_FALSE, 1, map->conformal_factor);
}

static PetscErrorCode MakeImage(EqmMap map, Slabs *slabs)
{
  const PetscInt n = map->soup->vertex_end - map->soup->vertex_start;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * n, &slabs->image));
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt d = 0; d < 3; d++)
      slabs->image[3 * i + d] = d < map->dim ? map->image_scale * map->coordinates[map->dim * i + d] : 0.;
  }
  PetscFunctionReturn(0);
}

/* The map as fields of the surface, u and v in the plane. */
static PetscErrorCode AddImages(EqmMap map, Slabs *slabs)
{
  static const char *const names[] = {"u", "v"};
  const PetscInt n = map->soup->vertex_end - map->soup->vertex_start;

  PetscFunctionBegin;
  if (map->dim == 3) AddField(slabs, "map", PETSC_FALSE, 3, map->coordinates);
  for (PetscInt d = 0; d < map->dim && map->dim == 2; d++) {
    PetscCall(PetscMalloc1(n, &slabs->plane[d]));
    for (PetscInt i = 0; i < n; i++) slabs->plane[d][i] = map->coordinates[2 * i + d];
    AddField(slabs, names[d], PETSC_FALSE, 1, slabs->plane[d]);
  }
  PetscFunctionReturn(0);
}

/* Beside a .vtu of the image: the surface with the map as fields. */
static PetscErrorCode WriteSurface(EqmMap map, const char *file, Slabs *slabs)
{
  const PetscInt num_fields = slabs->num_fields;
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(AddImages(map, slabs));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%.*s.surface.vtu", (int)(strlen(file) - strlen(".vtu")), file));
  PetscCall(EqmFormatWriteSlabs(map->soup, map->soup->vertices, slabs->fields, slabs->num_fields, PETSC_TRUE, name));
  slabs->num_fields = num_fields;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapSetImageScale(EqmMap map, PetscReal scale)
{
  PetscFunctionBegin;
  if (!(scale > 0.) || PetscIsInfOrNanReal(scale))
    EqmFail(map->soup->comm, EQM_ERR_USAGE, "-radius %.6g: give a positive number", (double)scale);
  map->image_scale = scale;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file)
{
  Slabs slabs = {0};

  PetscFunctionBegin;
  AddRatios(map, &slabs);
  if (EqmHasSuffix(file, ".vtu")) PetscCall(WriteSurface(map, file, &slabs));
  PetscCall(MakeImage(map, &slabs));
  if (EqmHasSuffix(file, ".vtu") || EqmHasSuffix(file, ".vtk"))
    AddField(&slabs, "surface", PETSC_FALSE, 3, map->soup->vertices);
  PetscCall(EqmFormatWriteSlabs(map->soup, slabs.image, slabs.fields, slabs.num_fields, PETSC_TRUE, file));
  PetscCall(PetscFree(slabs.image));
  for (PetscInt d = 0; d < 2; d++) PetscCall(PetscFree(slabs.plane[d]));
  PetscFunctionReturn(0);
}
