/* XDMF, as ParaView, meshio and FEniCS write it: XML that names arrays of an HDF5 file beside, which all ranks read, or
   has them in its text. */
#define _GNU_SOURCE
#include "base/rows.h"
#include "format.h"
#include "h5/h5.h"
#include "mesh/fields.h"
#include "mesh/soup_private.h"
#include "xdmf_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static PetscBool RecogniseXdmf(const char *bytes, size_t length)
{
  return memmem(bytes, PetscMin(length, 4096), "<Xdmf", 5) ? PETSC_TRUE : PETSC_FALSE;
}

/* This rank's share of an array's rows. */
static PetscErrorCode SlabOf(MPI_Comm comm, const EqmXdmfArray *array, EqmSlab *slab)
{
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  slab->total = (PetscInt)array->rows;
  slab->start = (PetscInt)(array->rows * rank / size);
  slab->count = (PetscInt)(array->rows * (rank + 1) / size) - slab->start;
  slab->width = (PetscInt)array->width;
  PetscFunctionReturn(0);
}

/* Numbers of an HDF5 file that are as many as the XDMF file says, in rows of their own width or as one long row. */
static PetscErrorCode CheckInHdf5(EqmH5 h5, const EqmXdmfArray *array, PetscInt64 *rows, PetscInt64 *width)
{
  PetscBool has, fits;
  char what[EQM_XDMF_PATH + 128];

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, array->path, &has));
  (void)snprintf(what, sizeof(what), "it has no %s, which the XDMF file names", array->path);
  PetscCall(EqmH5Agree(h5, has, what));
  PetscCall(EqmH5GetShape(h5, array->path, rows, width));
  PetscCall(EqmH5CheckRows(h5, array->path, *rows));
  (void)snprintf(what, sizeof(what), "%s has not the %lld x %lld numbers that the XDMF file says", array->path,
                 (long long)array->rows, (long long)array->width);
  fits = *width <= 1 ? (PetscBool)(*rows == array->rows * array->width)
                     : (PetscBool)(*rows == array->rows && *width == array->width);
  PetscCall(EqmH5Agree(h5, fits, what));
  PetscFunctionReturn(0);
}

/* Open the HDF5 file of an array, beside the XDMF file. Collective. */
static PetscErrorCode OpenHdf5(MPI_Comm comm, const char *file, const EqmXdmfArray *array, EqmH5 *h5)
{
  const char *const slash = strrchr(file, '/');
  char name[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%.*s%s", slash && array->file[0] != '/' ? (int)(slash + 1 - file) : 0,
                          file, array->file));
  PetscCall(EqmH5Open(comm, name, h5));
  PetscFunctionReturn(0);
}

/* Is the array there, before there is memory for it? Collective. */
static PetscErrorCode CheckArray(MPI_Comm comm, const char *file, const EqmXdmfArray *array)
{
  PetscInt64 rows, width;
  PetscErrorCode code;
  EqmH5 h5;

  PetscFunctionBegin;
  if (!array->path[0]) PetscFunctionReturn(0); /* the text has been read */
  PetscCall(OpenHdf5(comm, file, array, &h5));
  code = CheckInHdf5(h5, array, &rows, &width);
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadFromHdf5(EqmH5 h5, const EqmXdmfArray *array, EqmSlab slab, PetscReal *values)
{
  PetscInt64 rows, width;

  PetscFunctionBegin;
  PetscCall(CheckInHdf5(h5, array, &rows, &width));
  if (width <= 1) /* one long row */
    slab = (EqmSlab){(PetscInt)rows, slab.start * slab.width, slab.count * slab.width, (PetscInt)width};
  PetscCall(EqmH5ReadReals(h5, array->path, slab, values));
  PetscFunctionReturn(0);
}

/* This rank's rows of an array that has been checked. Collective. */
static PetscErrorCode ReadArray(MPI_Comm comm, const char *file, const EqmXdmfArray *array, EqmSlab slab,
                                PetscReal *values)
{
  PetscErrorCode code;
  PetscMPIInt rank;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!array->path[0]) {
    PetscCall(EqmFetchSlab(comm, rank == 0 ? slab.total : 0, slab.count, slab.start, MPIU_REAL, slab.width,
                           array->values, values));
    PetscFunctionReturn(0);
  }
  PetscCall(OpenHdf5(comm, file, array, &h5));
  code = ReadFromHdf5(h5, array, slab, values);
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

/* Corners as numbers of vertices; refused if they are none. Collective. */
static PetscErrorCode TakeCorners(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSlab slab,
                                  const PetscReal *corner, PetscInt *cells)
{
  PetscInt bad = PETSC_MAX_INT;

  PetscFunctionBegin;
  for (PetscInt64 k = (PetscInt64)slab.count * slab.width - 1; k >= 0; --k) {
    const PetscBool fine = corner[k] >= 0.0 && corner[k] < (PetscReal)plan->points.rows ? PETSC_TRUE : PETSC_FALSE;

    cells[k] = fine ? (PetscInt)corner[k] : 0;
    if (!fine || (PetscReal)cells[k] != corner[k]) bad = slab.start + (PetscInt)(k / slab.width);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MIN, comm));
  if (bad < PETSC_MAX_INT)
    EqmFail(comm, EQM_ERR_IO,
            "cannot read %s as XDMF: cell %" PetscInt_FMT
            ": a vertex index is out of range 0..%lld, or no whole number",
            file, bad, (long long)plan->points.rows - 1);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadCells(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSlab slab, PetscInt *cells)
{
  PetscErrorCode code;
  PetscReal *corner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((PetscInt64)slab.count * slab.width + 1, &corner));
  code = ReadArray(comm, file, &plan->cells, slab, corner);
  if (!code) code = TakeCorners(comm, file, plan, slab, corner, cells);
  PetscCall(PetscFree(corner));
  PetscCall(code);
  PetscFunctionReturn(0);
}

/* Points in space; those in the plane get z = 0. `vertices` holds zeros. */
static PetscErrorCode ReadPoints(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSlab slab,
                                 PetscReal *vertices)
{
  PetscErrorCode code;
  PetscReal *read;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((PetscInt64)slab.width * slab.count + 1, &read));
  code = ReadArray(comm, file, &plan->points, slab, read);
  for (PetscInt64 k = 0; k < (PetscInt64)slab.count * slab.width && !code; ++k)
    vertices[3 * (k / slab.width) + k % slab.width] = read[k];
  PetscCall(PetscFree(read));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadFields(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSoup soup)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < plan->num_fields; ++f) {
    EqmMeshField kind = {.on_cells = plan->on_cells[f], .width = (PetscInt)plan->field[f].width};
    PetscReal *values;
    EqmSlab slab;

    PetscCall(PetscStrncpy(kind.name, plan->name[f], sizeof(kind.name)));
    PetscCall(CheckArray(comm, file, &plan->field[f]));
    PetscCall(SlabOf(comm, &plan->field[f], &slab));
    PetscCall(EqmMeshFieldsAdd(&soup->num_fields, &soup->fields, &kind, (size_t)slab.count, &values));
    PetscCall(ReadArray(comm, file, &plan->field[f], slab, values));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadMesh(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSoup *soup)
{
  EqmSlab points, cells;
  PetscReal *vertices;
  PetscInt *corners;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(CheckArray(comm, file, &plan->points));
  PetscCall(CheckArray(comm, file, &plan->cells));
  PetscCall(SlabOf(comm, &plan->points, &points));
  PetscCall(SlabOf(comm, &plan->cells, &cells));
  PetscCall(PetscCalloc1(3 * (PetscInt64)points.count + 1, &vertices));
  PetscCall(PetscMalloc1((PetscInt64)cells.count * cells.width + 1, &corners));
  code = ReadPoints(comm, file, plan, points, vertices);
  if (!code) code = ReadCells(comm, file, plan, cells, corners);
  if (code) {
    PetscCall(PetscFree(vertices));
    PetscCall(PetscFree(corners));
    PetscFunctionReturn(code);
  }
  PetscCall(EqmSoupCreateFromSlabs(comm, plan->cell_size, points.count, vertices, cells.count, corners, file, soup));
  code = ReadFields(comm, file, plan, *soup);
  if (code) PetscCall(EqmSoupDestroy(soup));
  PetscFunctionReturn(code);
}

/* On rank 0. */
static PetscErrorCode MakePlan(const char *file, EqmXdmfPlan *plan, char *error, size_t length)
{
  char *bytes, reason[EQM_MESSAGE_MAX / 2] = "";
  size_t num_bytes;
  PetscErrorCode code = EqmFormatLoadBytes(file, &bytes, &num_bytes, error, length);

  if (!code) {
    code = EqmXdmfParse(bytes, num_bytes, plan, reason, sizeof(reason));
    if (!code && !plan->cells.rows) {
      (void)snprintf(reason, sizeof(reason), "the mesh has no cells: there is nothing to map");
      code = EQM_ERR_MESH;
    }
    if (code) (void)snprintf(error, length, "cannot read %.1000s as XDMF: %s", file, reason);
  }
  free(bytes);
  return code;
}

/* Read the first grid of an XDMF file. Collective. Errors: EQM_ERR_IO, EQM_ERR_MESH (other cells, or none). */
static PetscErrorCode ReadXdmf(MPI_Comm comm, const char *file, EqmSoup *soup)
{
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;
  EqmXdmfPlan *plan;
  PetscMPIInt rank;

  PetscFunctionBegin;
  *soup = NULL;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscCalloc1(1, &plan));
  if (rank == 0) code = MakePlan(file, plan, error, sizeof(error));
  code = EqmAgree(comm, code, error);
  if (!code) {
    PetscCallMPI(MPI_Bcast(plan, (PetscMPIInt)sizeof(*plan), MPI_BYTE, 0, comm));
    code = ReadMesh(comm, file, plan, soup);
  }
  if (rank == 0) PetscCall(EqmXdmfReset(plan));
  PetscCall(PetscFree(plan));
  PetscCall(code);
  PetscFunctionReturn(0);
}

EQM_DEFINE_FORMAT(Xdmf) = {.name = "XDMF",
                           .suffixes = "xdmf xmf",
                           .recognise = RecogniseXdmf,
                           .read_parallel = ReadXdmf};
