/* The mesh part of our HDF5 files: /mesh/vertices, n x 3 float64, and /mesh/cells, m x 3 or 4 int64. All ranks read and
   write their slabs together. */
#include "hdf5.h"
#include "mesh/soup_private.h"
#include "format.h"
#include "h5/h5.h"

#include <stdio.h>
#include <string.h>

static const char vertices_path[] = "/mesh/vertices", cells_path[] = "/mesh/cells", density_path[] = "/cell/density";

/* EqmRecogniseHdf5 - the eight magic bytes. Not collective. */
PetscBool EqmRecogniseHdf5(const char *bytes, size_t length)
{
  static const char magic[] = "\211HDF\r\n\032\n";

  return length >= 8 && !memcmp(bytes, magic, 8) ? PETSC_TRUE : PETSC_FALSE;
}

/* This rank's share of `total` rows: contiguous, in rank order, sizes that differ by one at most. */
static PetscErrorCode SlabOf(MPI_Comm comm, PetscInt total, PetscInt width, EqmSlab *slab)
{
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  slab->total = total;
  slab->start = (PetscInt)((PetscInt64)total * rank / size);
  slab->count = (PetscInt)((PetscInt64)total * (rank + 1) / size) - slab->start;
  slab->width = width;
  PetscFunctionReturn(0);
}

/* The shape of an array that a file must have: `width` 0 (one-dimensional) or between `least` and `most`, rows that
   PetscInt can count and that the file can hold. */
static PetscErrorCode CheckShape(EqmH5 h5, const char *path, PetscInt least, PetscInt most, PetscInt64 *total,
                                 PetscInt64 *width)
{
  PetscBool has;
  char what[256];

  PetscFunctionBegin;
  snprintf(what, sizeof(what), "it has no %s; a mesh has %s (n x 3) and %s (m x 3 or m x 4)", path, vertices_path,
           cells_path);
  PetscCall(EqmH5HasDataset(h5, path, &has));
  PetscCall(EqmH5Agree(h5, has, what));
  PetscCall(EqmH5GetShape(h5, path, total, width));
  snprintf(what, sizeof(what), "%s is %lld x %lld; it must have %d%s columns", path, (long long)*total,
           (long long)*width, (int)least, most > least ? " or 4" : "");
  PetscCall(EqmH5Agree(h5, *width >= least && *width <= most ? PETSC_TRUE : PETSC_FALSE, what));
  PetscCall(EqmH5CheckRows(h5, path, *total));
  PetscFunctionReturn(0);
}

/* Narrow the corners to PetscInt; fail on all ranks if one names a vertex that is not there. */
static PetscErrorCode TakeCells(EqmH5 h5, EqmSlab slab, PetscInt64 num_vertices, const PetscInt64 *corners,
                                PetscInt *cells)
{
  char what[128] = "";
  PetscBool fine = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < (PetscInt64)slab.count * slab.width; ++i) {
    if (fine && (corners[i] < 0 || corners[i] >= num_vertices)) {
      fine = PETSC_FALSE;
      snprintf(what, sizeof(what), "cell %lld: vertex index %lld is out of range 0..%lld",
               (long long)(slab.start + i / slab.width), (long long)corners[i], (long long)num_vertices - 1);
    }
    cells[i] = (PetscInt)corners[i];
  }
  PetscCall(EqmH5Agree(h5, fine, what));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadCells(EqmH5 h5, EqmSlab slab, PetscInt64 num_vertices, PetscInt *cells)
{
  PetscInt64 *corners;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((PetscInt64)slab.count * slab.width + 1, &corners));
  code = EqmH5ReadIntegers(h5, cells_path, slab, corners);
  if (!code) code = TakeCells(h5, slab, num_vertices, corners, cells);
  PetscCall(PetscFree(corners));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadMesh(EqmH5 h5, const char *file, EqmSoup *soup)
{
  EqmSlab vertex_slab, cell_slab;
  PetscInt64 num_vertices, num_cells, width, cell_size;
  PetscReal *vertices = NULL;
  PetscInt *cells = NULL;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(CheckShape(h5, vertices_path, 3, 3, &num_vertices, &width));
  PetscCall(CheckShape(h5, cells_path, 3, 4, &num_cells, &cell_size));
  if (!num_cells)
    EqmFail(h5->comm, EQM_ERR_MESH, "%s: the mesh has no triangles or tetrahedra: there is nothing to map", file);
  PetscCall(SlabOf(h5->comm, (PetscInt)num_vertices, 3, &vertex_slab));
  PetscCall(SlabOf(h5->comm, (PetscInt)num_cells, (PetscInt)cell_size, &cell_slab));
  PetscCall(PetscMalloc1(3 * (PetscInt64)vertex_slab.count + 1, &vertices));
  PetscCall(PetscMalloc1(cell_size * cell_slab.count + 1, &cells));
  code = EqmH5ReadReals(h5, vertices_path, vertex_slab, vertices);
  if (!code) code = ReadCells(h5, cell_slab, num_vertices, cells);
  if (code) {
    PetscCall(PetscFree(vertices));
    PetscCall(PetscFree(cells));
    PetscFunctionReturn(code);
  }
  PetscCall(EqmSoupCreateFromSlabs(h5->comm, (PetscInt)cell_size, vertex_slab.count, vertices, cell_slab.count, cells,
                                   file, soup));
  PetscFunctionReturn(0);
}

/* EqmSoupReadHdf5 - read /mesh/vertices and /mesh/cells, each rank its slab.

   Collective. Errors: EQM_ERR_IO (missing, damaged, without these arrays, an index out of range), EQM_ERR_MESH (no
   cells). */
PetscErrorCode EqmSoupReadHdf5(MPI_Comm comm, const char *file, EqmSoup *soup)
{
  EqmH5 h5;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(comm, file, &h5));
  code = ReadMesh(h5, file, soup);
  if (!code) code = EqmSoupReadFieldsHdf5(h5, *soup);
  if (code) PetscCall(EqmSoupDestroy(soup));
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteCells(EqmH5 h5, EqmSoup soup, EqmSlab slab)
{
  PetscInt64 *corners;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((PetscInt64)slab.count * slab.width + 1, &corners));
  for (PetscInt64 i = 0; i < (PetscInt64)slab.count * slab.width; ++i) corners[i] = soup->cells[i];
  code = EqmH5WriteIntegers(h5, cells_path, slab, corners);
  PetscCall(PetscFree(corners));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode WriteMesh(EqmH5 h5, EqmSoup soup)
{
  const EqmSlab vertices = {soup->num_vertices, soup->vertex_start, soup->vertex_end - soup->vertex_start, 3};
  const EqmSlab cells = {soup->num_cells, soup->cell_start, soup->cell_end - soup->cell_start, soup->cell_size};
  const EqmSlab per_cell = {soup->num_cells, soup->cell_start, soup->cell_end - soup->cell_start, 0};

  PetscFunctionBegin;
  PetscCall(EqmH5DeclareReals(h5, vertices_path, soup->num_vertices, 3));
  PetscCall(EqmH5DeclareIntegers(h5, cells_path, soup->num_cells, soup->cell_size));
  if (soup->density) PetscCall(EqmH5DeclareReals(h5, density_path, soup->num_cells, 0));
  PetscCall(EqmSoupDeclareFieldsHdf5(h5, soup, PETSC_FALSE));
  PetscCall(EqmH5PutInteger(h5, "mesh_checksum", soup->checksum));
  PetscCall(EqmH5Reserve(h5));
  PetscCall(EqmH5WriteReals(h5, vertices_path, vertices, soup->vertices));
  PetscCall(WriteCells(h5, soup, cells));
  PetscCall(EqmSoupWriteFieldsHdf5(h5, soup, PETSC_FALSE));
  if (soup->density) PetscCall(EqmH5WriteReals(h5, density_path, per_cell, soup->density));
  PetscFunctionReturn(0);
}

/* EqmSoupWriteHdf5 - write /mesh/vertices, /mesh/cells and, where there is a density, /cell/density, each rank its
   slab; the attribute mesh_checksum is that of the soup.

   Collective. The file is there complete or not at all. Errors: EQM_ERR_IO. */
PetscErrorCode EqmSoupWriteHdf5(EqmSoup soup, const char *file)
{
  EqmH5 h5;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(EqmH5Create(soup->comm, file, &h5));
  code = WriteMesh(h5, soup);
  if (!code) code = EqmH5Commit(&h5);
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadDensity(EqmH5 h5, EqmSoup soup, PetscReal *density)
{
  const EqmSlab slab = {soup->num_cells, soup->cell_start, soup->cell_end - soup->cell_start, 0};
  PetscInt64 total, width;
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, density_path, &has));
  PetscCall(EqmH5Agree(h5, has, "it has no /cell/density"));
  PetscCall(EqmH5GetShape(h5, density_path, &total, &width));
  if (total != soup->num_cells || width != 0) {
    EqmFail(h5->comm, EQM_ERR_MESH,
            "%s: /cell/density has %lld values, but the mesh has %lld cells: one number per cell is needed", h5->name,
            (long long)(total * PetscMax(width, 1)), (long long)soup->num_cells);
  }
  PetscCall(EqmH5ReadReals(h5, density_path, slab, density));
  PetscFunctionReturn(0);
}

/* EqmSoupReadDensityHdf5 - read this rank's slab of /cell/density.

   Collective. density: one number per cell of the slab; their values are not checked. Errors: EQM_ERR_IO (missing,
   damaged, no such array), EQM_ERR_MESH (not one number per cell). */
PetscErrorCode EqmSoupReadDensityHdf5(EqmSoup soup, const char *file, PetscReal *density)
{
  EqmH5 h5;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(soup->comm, file, &h5));
  code = ReadDensity(h5, soup, density);
  PetscCall(EqmH5Close(&h5));
  PetscCall(code);
  PetscFunctionReturn(0);
}

EQM_DEFINE_FORMAT(Hdf5) = {.name = "HDF5",
                           .suffixes = "h5 hdf5",
                           .recognise = EqmRecogniseHdf5,
                           .read_parallel = EqmSoupReadHdf5,
                           .write_parallel = EqmSoupWriteHdf5};
