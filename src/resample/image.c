/* Geometry images: a regular mesh of the square as pixels [Gu, Gortler, Hoppe: Geometry images, 2002]. */
#include "resample/resample.h"
#include "base/atomicfile.h"
#include "base/rows.h"
#include "geometry/simplex.h"
#include "mesh/fields.h"
#include "mesh/soup_private.h"
#include "resample/pixels.h"
#include "store/store.h"
#include <string.h>

PetscBool EqmIsGeometryImage(const char *file)
{
  return (PetscBool)(EqmHasSuffix(file, ".png") || EqmIsTiff(file));
}

PetscErrorCode EqmGeometryImageCheck(MPI_Comm comm, const char *file)
{
  const char *const missing = EqmPixelsMissing(file);

  PetscFunctionBegin;
  if (missing)
    EqmFail(comm, EQM_ERR_USAGE, "cannot write '%s': this equimap was built without %s; install it and build again",
            file, missing);
  PetscFunctionReturn(0);
}

/* The normals of a mesh on rank 0, triangles weighted by their areas. */
static PetscErrorCode Normals(const EqmSerialMesh *mesh, PetscReal *normal)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(normal, 3 * mesh->num_vertices));
  for (PetscInt c = 0; c < mesh->num_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    PetscReal u[3], w[3], n[3];

    for (int k = 0; k < 3; k++) {
      u[k] = mesh->vertices[3 * v[1] + k] - mesh->vertices[3 * v[0] + k];
      w[k] = mesh->vertices[3 * v[2] + k] - mesh->vertices[3 * v[0] + k];
    }
    EqmCross(u, w, n);
    for (int a = 0; a < 3; a++) {
      for (int k = 0; k < 3; k++) normal[3 * v[a] + k] += n[k];
    }
  }
  for (PetscInt v = 0; v < mesh->num_vertices; v++) {
    const PetscReal length = PetscSqrtReal(EqmDot3(normal + 3 * v, normal + 3 * v));

    for (int k = 0; k < 3 && length > 0.; k++) normal[3 * v + k] /= length;
  }
  PetscFunctionReturn(0);
}

/* The numbers that the image shows, on rank 0, and how many per vertex. */
static PetscErrorCode Choose(EqmSoup soup, const char *quantity, EqmSerialMesh *mesh, PetscInt *width,
                             PetscReal **values)
{
  const EqmMeshField *const field = EqmMeshFieldsFind(soup->num_fields, soup->fields, quantity, PETSC_FALSE);
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  *width = 3;
  if (strcmp(quantity, "position") && strcmp(quantity, "normal")) {
    if (!field) EqmFail(soup->comm, EQM_ERR_USAGE, "-image %s: there is no such field", quantity);
    if (field->width > 4)
      EqmFail(soup->comm, EQM_ERR_USAGE, "-image %s: an image has at most 4 channels, this field has %" PetscInt_FMT,
              quantity, field->width);
    *width = field->width;
  }
  PetscCall(EqmSoupGather(soup, mesh));
  PetscCall(PetscMalloc1(rank == 0 ? *width * soup->num_vertices : 0, values));
  if (!strcmp(quantity, "position")) {
    if (rank == 0) PetscCall(PetscArraycpy(*values, mesh->vertices, 3 * mesh->num_vertices));
  } else if (!strcmp(quantity, "normal")) {
    if (rank == 0) PetscCall(Normals(mesh, *values));
  } else {
    PetscCall(EqmFetchSlab(soup->comm, soup->vertex_end - soup->vertex_start, rank == 0 ? soup->num_vertices : 0, 0,
                           MPIU_REAL, *width, field->values, *values));
  }
  PetscFunctionReturn(0);
}

/* On rank 0. */
static PetscErrorCode WriteFile(const EqmPixels *pixels, const char *file, char *message, size_t length)
{
  PetscErrorCode error;
  EqmAtomicFile out;

  if (EqmIsTiff(file)) {
    error = EqmAtomicBegin(file, &out, message, length);
    if (error) return error;
    error = EqmPixelsToTiff(pixels, out.temporary, message, length);
  } else {
    error = EqmAtomicOpen(file, &out, message, length);
    if (error) return error;
    error = EqmPixelsToPng(pixels, &out, message, length);
  }
  if (error) {
    EqmAtomicAbort(&out);
    return error;
  }
  return EqmAtomicCommit(&out, message, length);
}

PetscErrorCode EqmGeometryImageWrite(EqmSoup soup, PetscInt n, const char *quantity, const char *file)
{
  char message[EQM_MESSAGE_MAX] = "";
  EqmPixels pixels = {.size = (int)n, .quantity = quantity};
  PetscErrorCode error = 0;
  EqmSerialMesh mesh;
  PetscReal *values;
  PetscInt width;
  PetscMPIInt rank;

  PetscFunctionBegin;
  if (soup->cell_size != 3 || soup->num_vertices != n * n)
    EqmFail(soup->comm, EQM_ERR_USAGE, "%s: a geometry image is made of a map to the square; another target has none",
            file);
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(Choose(soup, quantity, &mesh, &width, &values));
  pixels.channels = (int)width;
  pixels.values = values;
  if (rank == 0) error = WriteFile(&pixels, file, message, sizeof(message));
  PetscCall(PetscFree(values));
  PetscCall(EqmSerialMeshReset(&mesh));
  PetscCall(EqmAgree(soup->comm, error, message));
  PetscFunctionReturn(0);
}
