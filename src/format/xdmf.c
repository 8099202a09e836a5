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

/* From an HDF5 file, whose array may be flat. */
static PetscErrorCode ReadFromHdf5(EqmH5 h5, const EqmXdmfArray *array, EqmSlab slab, PetscReal *values)
{
  PetscInt64 rows, width;
  PetscBool has;
  char what[EQM_XDMF_PATH + 128];

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, array->path, &has));
  (void)snprintf(what, sizeof(what), "it has no %s, which the XDMF file names", array->path);
  PetscCall(EqmH5Agree(h5, has, what));
  PetscCall(EqmH5GetShape(h5, array->path, &rows, &width));
  (void)snprintf(what, sizeof(what), "%s has not the %lld x %lld numbers that the XDMF file says", array->path,
                 (long long)array->rows, (long long)array->width);
  PetscCall(EqmH5Agree(h5, rows * PetscMax(width, 1) == array->rows * array->width ? PETSC_TRUE : PETSC_FALSE, what));
  if (rows != slab.total) { /* flat */
    PetscCall(EqmH5Agree(h5, width <= 1 && rows <= PETSC_MAX_INT ? PETSC_TRUE : PETSC_FALSE, what));
    slab = (EqmSlab){(PetscInt)rows, slab.start * slab.width, slab.count * slab.width, (PetscInt)width};
  } else {
    slab.width = (PetscInt)width;
  }
  PetscCall(EqmH5ReadReals(h5, array->path, slab, values));
  PetscFunctionReturn(0);
}

/* This rank's rows of an array. Collective. */
static PetscErrorCode ReadArray(MPI_Comm comm, const char *file, const EqmXdmfArray *array, EqmSlab slab,
                                PetscReal *values)
{
  const char *const slash = strrchr(file, '/');
  char name[PETSC_MAX_PATH_LEN];
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
  PetscCall(PetscSNPrintf(name, sizeof(name), "%.*s%s", slash && array->file[0] != '/' ? (int)(slash + 1 - file) : 0,
                          file, array->file));
  PetscCall(EqmH5Open(comm, name, &h5));
  code = ReadFromHdf5(h5, array, slab, values);
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

/* Corners as numbers of vertices; refused if they are none. */
static PetscErrorCode TakeCells(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSlab slab,
                                PetscInt **cells)
{
  PetscInt bad = PETSC_MAX_INT;
  PetscReal *corner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(slab.count * slab.width + 1, cells));
  PetscCall(PetscMalloc1(slab.count * slab.width + 1, &corner));
  PetscCall(ReadArray(comm, file, &plan->cells, slab, corner));
  for (PetscInt k = slab.count * slab.width - 1; k >= 0; --k) {
    const PetscBool fine = corner[k] >= 0.0 && corner[k] < (PetscReal)plan->points.rows ? PETSC_TRUE : PETSC_FALSE;

    (*cells)[k] = fine ? (PetscInt)corner[k] : 0;
    if (!fine) bad = slab.start + k / slab.width;
  }
  PetscCall(PetscFree(corner));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MIN, comm));
  if (bad < PETSC_MAX_INT)
    EqmFail(comm, EQM_ERR_IO, "cannot read %s as XDMF: cell %" PetscInt_FMT ": a vertex index is out of range 0..%lld",
            file, bad, (long long)plan->points.rows - 1);
  PetscFunctionReturn(0);
}

/* Points in space; those in the plane get z = 0. */
static PetscErrorCode TakePoints(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSlab slab,
                                 PetscReal **vertices)
{
  PetscReal *read;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(3 * slab.count + 1, vertices));
  PetscCall(PetscMalloc1(slab.width * slab.count + 1, &read));
  PetscCall(ReadArray(comm, file, &plan->points, slab, read));
  for (PetscInt k = 0; k < slab.count * slab.width; ++k) (*vertices)[3 * (k / slab.width) + k % slab.width] = read[k];
  PetscCall(PetscFree(read));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadMesh(MPI_Comm comm, const char *file, const EqmXdmfPlan *plan, EqmSoup *soup)
{
  EqmSlab points, cells;
  PetscReal *vertices, *values;
  PetscInt *corners;

  PetscFunctionBegin;
  PetscCall(SlabOf(comm, &plan->points, &points));
  PetscCall(SlabOf(comm, &plan->cells, &cells));
  PetscCall(TakePoints(comm, file, plan, points, &vertices));
  PetscCall(TakeCells(comm, file, plan, cells, &corners));
  PetscCall(EqmSoupCreateFromSlabs(comm, plan->cell_size, points.count, vertices, cells.count, corners, file, soup));
  for (PetscInt f = 0; f < plan->num_fields; ++f) {
    EqmMeshField kind = {.on_cells = plan->on_cells[f], .width = (PetscInt)plan->field[f].width};
    EqmSlab slab;

    PetscCall(PetscStrncpy(kind.name, plan->name[f], sizeof(kind.name)));
    PetscCall(SlabOf(comm, &plan->field[f], &slab));
    PetscCall(EqmMeshFieldsAdd(&(*soup)->num_fields, &(*soup)->fields, &kind, (size_t)slab.count, &values));
    PetscCall(ReadArray(comm, file, &plan->field[f], slab, values));
  }
  PetscFunctionReturn(0);
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
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscCalloc1(1, &plan));
  if (rank == 0) code = MakePlan(file, plan, error, sizeof(error));
  PetscCall(EqmAgree(comm, code, error));
  PetscCallMPI(MPI_Bcast(plan, (PetscMPIInt)sizeof(*plan), MPI_BYTE, 0, comm));
  code = ReadMesh(comm, file, plan, soup);
  if (rank == 0) PetscCall(EqmXdmfReset(plan));
  PetscCall(PetscFree(plan));
  PetscCall(code);
  PetscFunctionReturn(0);
}

EQM_DEFINE_FORMAT(Xdmf) = {.name = "XDMF",
                           .suffixes = "xdmf xmf",
                           .recognise = RecogniseXdmf,
                           .read_parallel = ReadXdmf};
