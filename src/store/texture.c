/* A map as the texture coordinates of its surface, for programs that paint it. */
#include "store/map_private.h"
#include "mesh/soup_private.h"
#include "base/rows.h"
#include "format/format.h"

/* On rank 0. Points of the plane go to the unit square: the unit disk is halved and moved, the unit square is it
 * already.
 */
static void FillFromPlane(const EqmSerialMesh *mesh, const PetscReal *images, PetscReal *texture)
{
  PetscReal least = 0.;

  for (size_t i = 0; i < 2 * (size_t)mesh->num_vertices; i++) least = PetscMin(least, images[i]);
  for (size_t i = 0; i < 3 * (size_t)mesh->num_cells; i++) {
    for (size_t k = 0; k < 2; k++) {
      const PetscReal x = images[2 * (size_t)mesh->cells[i] + k];

      texture[2 * i + k] = least < 0. ? .5 * (1. + x) : x;
    }
  }
}

/* Longitude in [0, 1), from 0 at -x eastward, and latitude in [0, 1], from the south pole. */
static void ToLongitude(const PetscReal p[3], PetscReal uv[2])
{
  const PetscReal flat = PetscSqrtReal(p[0] * p[0] + p[1] * p[1]);

  uv[0] = .5 + PetscAtan2Real(p[1], p[0]) / (2. * PETSC_PI);
  if (uv[0] >= 1.) uv[0] = 0.;
  uv[1] = .5 + PetscAtan2Real(p[2], flat) / PETSC_PI;
}

/* On rank 0. A triangle that the seam at longitude 0 runs through has its western corners one round further east, and a
   corner at a pole has the mean longitude of the other two. */
static void FillFromSphere(const EqmSerialMesh *mesh, const PetscReal *images, PetscReal *texture)
{
  const PetscReal near_pole = 1e-9;

  for (size_t c = 0; c < (size_t)mesh->num_cells; c++) {
    PetscReal *const uv = texture + 6 * c;
    PetscReal most = 0.;
    PetscBool pole[3];

    for (size_t a = 0; a < 3; a++) {
      const PetscReal *const p = images + 3 * (size_t)mesh->cells[3 * c + a];

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

/* Gather surface and images on rank 0 and turn them into a textured mesh. Collective. */
static PetscErrorCode MakeTextured(EqmMap map, EqmSerialMesh *mesh)
{
  const EqmSoup soup = map->soup;
  PetscReal *images;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(EqmSoupGather(soup, mesh));
  PetscCall(PetscMalloc1(map->dim * mesh->num_vertices, &images));
  PetscCall(EqmFetchSlab(soup->comm, soup->vertex_end - soup->vertex_start, mesh->num_vertices, 0, MPIU_REAL, map->dim,
                         map->coordinates, images));
  if (rank == 0) {
    PetscCall(PetscFree(mesh->texture)); /* the input's own */
    PetscCall(PetscMalloc1(6 * (size_t)mesh->num_cells, &mesh->texture));
    if (map->dim == 2)
      FillFromPlane(mesh, images, mesh->texture);
    else
      FillFromSphere(mesh, images, mesh->texture);
  }
  PetscCall(PetscFree(images));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapWriteTexture(EqmMap map, const char *file)
{
  const EqmFormat *const format = EqmFormatOfSuffix(file);
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  EqmSerialMesh mesh;
  PetscMPIInt rank;

  PetscFunctionBegin;
  if (!format || !format->writes_texture)
    EqmFail(map->soup->comm, EQM_ERR_USAGE, "cannot write texture coordinates to '%s': choose .obj or .ply", file);
  if (map->soup->cell_size != 3)
    EqmFail(map->soup->comm, EQM_ERR_USAGE, "cannot write '%s': solids have no texture coordinates", file);
  PetscCallMPI(MPI_Comm_rank(map->soup->comm, &rank));
  PetscCall(MakeTextured(map, &mesh));
  if (rank == 0) error = EqmFormatWriteSerial(file, &mesh, NULL, 0, message, sizeof(message));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscCall(EqmAgree(map->soup->comm, error, message));
  PetscFunctionReturn(0);
}
