/* A map as the texture coordinates of its surface, for programs that paint it. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "base/rows.h"
#include "format/format.h"
#include "mesh/fields.h"

/* Points of the plane go to the unit square: the unit disk is halved and moved, the unit square is it already. `least`:
   the lowest coordinate of all vertices. */
static void FillFromPlane(PetscInt num_cells, const PetscReal *images, PetscReal least, PetscReal *texture)
{
  for (size_t i = 0; i < 6 * (size_t)num_cells; i++) texture[i] = least < 0. ? .5 * (1. + images[i]) : images[i];
}

/* Longitude in [0, 1), from 0 at -x eastward, and latitude in [0, 1], from the south pole. */
static void ToLongitude(const PetscReal p[3], PetscReal uv[2])
{
  const PetscReal flat = PetscSqrtReal(p[0] * p[0] + p[1] * p[1]);

  uv[0] = .5 + PetscAtan2Real(p[1], p[0]) / (2. * PETSC_PI);
  if (uv[0] >= 1.) uv[0] = 0.;
  uv[1] = .5 + PetscAtan2Real(p[2], flat) / PETSC_PI;
}

/* A triangle that the seam at longitude 0 runs through has its western corners one round further east, and a
   corner at a pole has the mean longitude of the other two. */
static void FillFromSphere(PetscInt num_cells, const PetscReal *images, PetscReal *texture)
{
  const PetscReal near_pole = 1e-9;

  for (size_t c = 0; c < (size_t)num_cells; c++) {
    PetscReal *const uv = texture + 6 * c;
    PetscReal most = 0.;
    PetscBool pole[3];

    for (size_t a = 0; a < 3; a++) {
      const PetscReal *const p = images + 3 * (3 * c + a);

      ToLongitude(p, uv + 2 * a);
      pole[a] = (PetscBool)(PetscAbsReal(p[0]) + PetscAbsReal(p[1]) < near_pole);
      if (!pole[a]) most = PetscMax(most, uv[2 * a]);
    }
    for (size_t a = 0; a < 3; a++) {
      if (!pole[a] && most - uv[2 * a] > .5) uv[2 * a] += 1.;
    }
    for (size_t a = 0; a < 3; a++) {
      if (pole[a]) uv[2 * a] = .5 * (uv[2 * ((a + 1) % 3)] + uv[2 * ((a + 2) % 3)]);
    }
  }
}

/* The texture points of the corners of this rank's cells, from the images of their vertices. Collective. */
static PetscErrorCode Fill(EqmMap map, PetscReal *texture)
{
  const EqmSoup soup = map->soup;
  const PetscInt num_vertices = soup->vertex_end - soup->vertex_start, num_cells = soup->cell_end - soup->cell_start;
  PetscReal least = 0., *images;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * map->dim * num_cells, &images));
  PetscCall(EqmFetchRows(soup->comm, num_vertices, 3 * num_cells, soup->cells, MPIU_REAL, map->dim, map->coordinates,
                         images));
  for (PetscInt k = 0; k < map->dim * num_vertices; k++) least = PetscMin(least, map->coordinates[k]);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &least, 1, MPIU_REAL, MPIU_MIN, soup->comm));
  if (map->dim == 2)
    FillFromPlane(num_cells, images, least, texture);
  else
    FillFromSphere(num_cells, images, texture);
  PetscCall(PetscFree(images));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteTexture(EqmMap map, const char *file)
{
  const EqmSoup soup = map->soup;
  const EqmFormat *const format = EqmFormatOfSuffix(file);
  EqmField field = {.name = EQM_FIELD_TEXTURE, .on_cells = PETSC_TRUE, .width = 6};
  PetscReal *texture;

  PetscFunctionBegin;
  if (!format || !format->writes_texture)
    EqmFail(soup->comm, EQM_ERR_USAGE, "cannot write texture coordinates to '%s': choose .obj or .ply", file);
  if (soup->cell_size != 3)
    EqmFail(soup->comm, EQM_ERR_USAGE, "cannot write '%s': solids have no texture coordinates", file);
  PetscCall(PetscMalloc1(6 * (soup->cell_end - soup->cell_start) + 1, &texture));
  PetscCall(Fill(map, texture));
  field.values = texture;
  PetscCall(EqmFormatWriteSlabs(soup, soup->vertices, &field, 1, PETSC_FALSE, file));
  PetscCall(PetscFree(texture));
  PetscFunctionReturn(0);
}
