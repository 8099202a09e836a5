#include "image.h"
#include "mesh/soup_private.h"
#include "base/rows.h"
#include "format.h"
#include "input.h"
#include "points.h"
#include "seam.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What rank 0 works with. */
typedef struct {
  const char *file;
  EqmSerialMesh mesh, read; /* the given mesh, the mesh in the file */
  PetscInt dim, num;        /* of the image: coordinates per vertex, vertices */
  PetscReal *points;        /* 3 * num; the third is 0 where dim is 2 */
  EqmSeams seams;           /* of the texture, where that is the image */
  char error[EQM_MESSAGE_MAX];
} Root;

static PetscErrorCode Refuse(Root *root, PetscErrorCode code, const char *what)
{
  snprintf(root->error, sizeof(root->error), "%.1000s %s", root->file, what);
  return code;
}

static PetscErrorCode CheckCount(Root *root, PetscInt count)
{
  char what[256];

  if (count == root->mesh.num_vertices) return 0;
  snprintf(what, sizeof(what), "has %lld vertices, but the mesh has %lld: they do not belong together",
           (long long)count, (long long)root->mesh.num_vertices);
  return Refuse(root, EQM_ERR_MESH, what);
}

/* Diagonal of the box around the vertices that cells use. */
static PetscReal SizeOf(const EqmSerialMesh *mesh)
{
  PetscReal low[3] = {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL}, squared = 0.0;
  PetscReal high[3] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL, -PETSC_MAX_REAL};

  for (size_t i = 0; i < (size_t)mesh->cell_size * (size_t)mesh->num_cells; ++i) {
    const PetscReal *const x = mesh->vertices + 3 * (size_t)mesh->cells[i];

    for (int k = 0; k < 3; ++k) {
      low[k] = PetscMin(low[k], x[k]);
      high[k] = PetscMax(high[k], x[k]);
    }
  }
  for (int k = 0; k < 3; ++k) squared += PetscSqr(high[k] - low[k]);
  return PetscSqrtReal(squared);
}

/* Do the corners of the file's cells lie where those of the mesh's cells do, up to single precision? */
static PetscBool Repeats(const Root *root)
{
  const EqmSerialMesh *const a = &root->mesh, *const b = &root->read;
  const PetscReal tolerance = 1e-5 * SizeOf(a);

  if (a->num_cells != b->num_cells || a->cell_size != b->cell_size) return PETSC_FALSE;
  for (size_t i = 0; i < (size_t)a->cell_size * (size_t)a->num_cells; ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const PetscReal difference = a->vertices[3 * (size_t)a->cells[i] + k] - b->vertices[3 * (size_t)b->cells[i] + k];

      if (!(PetscAbsReal(difference) <= tolerance)) return PETSC_FALSE;
    }
  }
  return PETSC_TRUE;
}

/* The image is the texture: that of the mesh cut along the seams. */
static PetscErrorCode TakeTexture(Root *root)
{
  const EqmSerialMesh *const mesh = &root->mesh;

  EqmTry(EqmSeamsFind(mesh->num_vertices, mesh->num_cells, mesh->cells, root->read.texture, &root->seams));
  root->dim = 2;
  root->num = root->seams.num;
  EqmTry(PetscCalloc1(3 * (size_t)root->num + 1, &root->points));
  for (size_t i = 0; i < (size_t)root->num; ++i) {
    for (size_t k = 0; k < 2; ++k) root->points[3 * i + k] = root->seams.point[2 * i + k];
  }
  return 0;
}

/* The image stands in the vertices: of the plane where all have one height, and always in space for solids. */
static PetscErrorCode TakeVertices(Root *root, PetscInt num, PetscReal **points)
{
  EqmTry(CheckCount(root, num));
  root->points = *points;
  *points = NULL;
  root->num = num;
  root->dim = root->mesh.cell_size == 4 ? 3 : 2;
  for (size_t i = 0; i < (size_t)num && root->dim == 2; ++i) {
    if (root->points[3 * i + 2] != root->points[2]) root->dim = 3;
  }
  return 0;
}

static PetscErrorCode TakeMesh(Root *root, EqmImageSource source)
{
  if (source != EQM_IMAGE_VERTICES && root->mesh.cell_size == 3 && root->read.texture && Repeats(root))
    return TakeTexture(root);
  if (source == EQM_IMAGE_TEXTURE) {
    return Refuse(root, EQM_ERR_MESH,
                  root->read.texture
                      ? "has other faces than the mesh: its texture coordinates belong to another surface"
                      : "has no texture coordinates, or not at every corner");
  }
  return TakeVertices(root, root->read.num_vertices, &root->read.vertices);
}

/* CSV or NPY: `bytes` of the file. */
static PetscErrorCode TakePoints(Root *root, const char *bytes, size_t length)
{
  char reason[EQM_MESSAGE_MAX / 2] = "";
  EqmPoints points;
  PetscReal *in_space;
  PetscErrorCode code = EqmPointsParse(bytes, length, &points, reason, sizeof(reason));

  if (code == EQM_ERR_IO) snprintf(root->error, sizeof(root->error), "cannot read %.1000s: %s", root->file, reason);
  if (code) return code;
  EqmTry(PetscCalloc1(3 * (size_t)points.num + 1, &in_space));
  for (size_t i = 0; i < (size_t)points.num; ++i) {
    for (size_t k = 0; k < (size_t)points.dim; ++k) in_space[3 * i + k] = points.values[(size_t)points.dim * i + k];
  }
  code = TakeVertices(root, points.num, &in_space);
  EqmTry(PetscFree(points.values));
  EqmTry(PetscFree(in_space));
  return code;
}

/* On rank 0: read the file; `row` is that of a format that all ranks must read, or -1. */
static PetscErrorCode ReadOnRoot(Root *root, EqmImageSource source, int *row)
{
  char *bytes;
  size_t length;
  PetscErrorCode code = EqmFormatLoadBytes(root->file, &bytes, &length, root->error, sizeof(root->error));

  *row = -1;
  if (!code && EqmPointsRecognise(root->file, bytes, length)) {
    code = TakePoints(root, bytes, length);
  } else if (!code) {
    code = EqmFormatReadOnRank(root->file, row, &root->read, root->error, sizeof(root->error));
    if (!code && !EqmFormatAt(*row)->read_parallel) {
      *row = -1;
      code = TakeMesh(root, source);
    }
  }
  free(bytes);
  return code;
}

/* Read the file on rank 0, or on all ranks and gather it there. Collective. */
static PetscErrorCode ReadFile(MPI_Comm comm, EqmImageSource source, Root *root)
{
  PetscErrorCode code = 0;
  PetscMPIInt rank;
  EqmSoup soup;
  int row = -1;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) code = ReadOnRoot(root, source, &row);
  PetscCall(EqmAgree(comm, code, root->error));
  PetscCallMPI(MPI_Bcast(&row, 1, MPI_INT, 0, comm));
  if (row < 0) PetscFunctionReturn(0);
  PetscCall(EqmFormatAt(row)->read_parallel(comm, root->file, &soup));
  PetscCall(EqmSoupGather(soup, &root->read));
  PetscCall(EqmSoupDestroy(&soup));
  if (rank == 0) code = TakeMesh(root, source);
  PetscCall(EqmAgree(comm, code, root->error));
  PetscFunctionReturn(0);
}

/* The mesh cut along seams as a soup, with the density of its cells. Collective. */
static PetscErrorCode MakeCutSoup(EqmSoup soup, Root *root, EqmSoup *cut)
{
  EqmSerialMesh serial = {.num_vertices = root->num, .num_cells = root->mesh.num_cells, .cell_size = 3};

  PetscFunctionBegin;
  if (root->seams.corner) { /* rank 0 */
    PetscCall(PetscMalloc1(3 * (size_t)root->num, &serial.vertices));
    for (size_t i = 0; i < (size_t)root->num; ++i)
      PetscCall(PetscArraycpy(serial.vertices + 3 * i, root->mesh.vertices + 3 * (size_t)root->seams.original[i], 3));
    serial.cells = root->seams.corner;
    root->seams.corner = NULL;
  }
  PetscCall(EqmSoupCreateFromRoot(soup->comm, &serial, soup->file, cut));
  if (soup->density) {
    const PetscInt count = (*cut)->cell_end - (*cut)->cell_start;

    PetscCall(PetscMalloc1(count + 1, &(*cut)->density));
    PetscCall(EqmFetchSlab(soup->comm, soup->cell_end - soup->cell_start, count, (*cut)->cell_start, MPIU_REAL, 1,
                           soup->density, (*cut)->density));
  }
  PetscFunctionReturn(0);
}

/* Deal the points of rank 0 to the slabs of the image's soup. Collective. */
static PetscErrorCode DealPoints(Root *root, EqmImage *image)
{
  EqmSoup soup = image->soup;
  const PetscInt count = soup->vertex_end - soup->vertex_start;
  PetscMPIInt rank;
  PetscReal *points;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMalloc1(3 * count + 1, &points));
  PetscCall(EqmFetchSlab(soup->comm, rank == 0 ? root->num : 0, count, soup->vertex_start, MPIU_REAL, 3, root->points,
                         points));
  PetscCall(PetscMalloc1(image->dim * count + 1, &image->coordinates));
  for (PetscInt i = 0; i < count; ++i) {
    for (PetscInt k = 0; k < image->dim; ++k) image->coordinates[image->dim * i + k] = points[3 * i + k];
  }
  PetscCall(PetscFree(points));
  PetscFunctionReturn(0);
}

static PetscErrorCode FillImage(EqmSoup soup, Root *root, EqmImage *image)
{
  PetscInt shape[3] = {root->dim, root->seams.original ? 1 : 0, root->num - root->mesh.num_vertices};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(shape, 3, MPIU_INT, 0, soup->comm));
  image->dim = shape[0];
  image->texture = shape[1] ? PETSC_TRUE : PETSC_FALSE;
  image->num_copies = shape[2];
  image->owned = image->num_copies ? PETSC_TRUE : PETSC_FALSE;
  image->soup = soup;
  if (image->owned) PetscCall(MakeCutSoup(soup, root, &image->soup));
  PetscCall(DealPoints(root, image));
  PetscFunctionReturn(0);
}

/* EqmImageRead - read the image of a mesh from a file of any kind: a mesh, CSV (x,y or x,y,z per vertex, with or
   without a vertex number before them), or an NPY array of n x 2 or n x 3.

   Collective; rank 0 gathers the mesh and reads. source - which numbers of a mesh file are the image. Texture
   coordinates belong to the corners of triangles: where two corners of one vertex have different ones, there is a seam,
   and the image is that of the mesh cut along it. image - to be freed with EqmImageReset. Errors: EQM_ERR_IO,
   EQM_ERR_MESH (another number of vertices; no texture coordinates, or those of another surface). */
PetscErrorCode EqmImageRead(EqmSoup soup, const char *file, EqmImageSource source, EqmImage *image)
{
  Root root = {.file = file};
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(image, sizeof(*image)));
  PetscCall(EqmSoupGather(soup, &root.mesh));
  code = ReadFile(soup->comm, source, &root);
  if (!code) code = FillImage(soup, &root, image);
  PetscCall(EqmSerialMeshReset(&root.mesh));
  PetscCall(EqmSerialMeshReset(&root.read));
  PetscCall(PetscFree(root.points));
  PetscCall(EqmSeamsReset(&root.seams));
  PetscCall(code);
  PetscFunctionReturn(0);
}

/* EqmImageReset - free what an image owns. Collective. */
PetscErrorCode EqmImageReset(EqmImage *image)
{
  PetscFunctionBegin;
  if (image->owned) PetscCall(EqmSoupDestroy(&image->soup));
  PetscCall(PetscFree(image->coordinates));
  PetscCall(PetscMemzero(image, sizeof(*image)));
  PetscFunctionReturn(0);
}
