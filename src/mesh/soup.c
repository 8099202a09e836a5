/* The mesh of a file, dealt to the ranks in contiguous slabs of vertices and of cells. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "mesh/fields.h"
#include "base/checksum.h"
#include <string.h>

/* The checksum of all vertices, then all cells: the same for any number of ranks. Collective. */
PetscErrorCode EqmSoupComputeChecksum(EqmSoup soup)
{
  const PetscInt64 num_reals = 3 * (PetscInt64)(soup->vertex_end - soup->vertex_start);
  const PetscInt64 num_integers = soup->cell_size * (PetscInt64)(soup->cell_end - soup->cell_start);
  EqmChecksum vertices, cells;

  PetscFunctionBegin;
  PetscCall(EqmChecksumJoin(soup->comm, EqmChecksumReals(num_reals, soup->vertices), &vertices));
  PetscCall(EqmChecksumJoin(soup->comm, EqmChecksumIntegers(num_integers, soup->cells), &cells));
  soup->checksum = EqmChecksumAppend(vertices, cells).crc;
  PetscFunctionReturn(0);
}

/* Tells this mesh with this density from others: the same for any number of ranks. Collective. */
PetscErrorCode EqmSoupComputeIdentity(EqmSoup soup, PetscInt64 *identity)
{
  const PetscInt num_cells = soup->cell_end - soup->cell_start;
  EqmChecksum density, both = {soup->checksum, 0};

  PetscFunctionBegin;
  if (soup->density) {
    PetscCall(EqmChecksumJoin(soup->comm, EqmChecksumReals(num_cells, soup->density), &density));
    both = EqmChecksumAppend(both, density);
  }
  *identity = both.crc;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupCreateFromSlabs(MPI_Comm comm, PetscInt cell_size, PetscInt num_local_vertices,
                                      PetscReal *vertices, PetscInt num_local_cells, PetscInt *cells, const char *file,
                                      EqmSoup *soup)
{
  const PetscInt64 mine[2] = {num_local_vertices, num_local_cells};
  PetscInt64 end[2], total[2];
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscNew(soup));
  (*soup)->comm = comm;
  (*soup)->cell_size = cell_size;
  (*soup)->vertices = vertices;
  (*soup)->cells = cells;
  PetscCall(PetscStrncpy((*soup)->file, file ? file : "", sizeof((*soup)->file)));
  PetscCallMPI(MPI_Scan(mine, end, 2, MPIU_INT64, MPI_SUM, comm));
  memcpy(total, end, sizeof(total));
  PetscCallMPI(MPI_Bcast(total, 2, MPIU_INT64, size - 1, comm));
  if (total[0] > PETSC_MAX_INT || total[1] > PETSC_MAX_INT) {
    PetscCall(EqmSoupDestroy(soup));
    EqmFail(comm, EQM_ERR_IO, "%s: the mesh has %lld vertices and %lld cells: build with 64-bit indices",
            file ? file : "mesh", (long long)total[0], (long long)total[1]);
  }
  (*soup)->num_vertices = (PetscInt)total[0];
  (*soup)->num_cells = (PetscInt)total[1];
  (*soup)->vertex_end = (PetscInt)end[0];
  (*soup)->vertex_start = (PetscInt)(end[0] - mine[0]);
  (*soup)->cell_end = (PetscInt)end[1];
  (*soup)->cell_start = (PetscInt)(end[1] - mine[1]);
  PetscCall(EqmSoupComputeChecksum(*soup));
  PetscFunctionReturn(0);
}

static PetscErrorCode CopyField(const EqmMeshField *field, size_t num_vertices, size_t num_cells, EqmSoup copy)
{
  const size_t rows = field->on_cells ? num_cells : num_vertices;
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(EqmMeshFieldsAdd(&copy->num_fields, &copy->fields, field, rows, &values));
  PetscCall(PetscArraycpy(values, field->values, rows * (size_t)field->width));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupCopy(EqmSoup soup, EqmSoup *copy)
{
  const size_t num_vertices = (size_t)(soup->vertex_end - soup->vertex_start);
  const size_t num_cells = (size_t)(soup->cell_end - soup->cell_start), width = (size_t)soup->cell_size;
  EqmSoup s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  *s = *soup;
  PetscCall(PetscStrallocpy(soup->metadata, &s->metadata));
  s->density = s->edge_length = NULL;
  s->num_fields = 0;
  s->fields = NULL;
  for (PetscInt f = 0; f < soup->num_fields; f++) PetscCall(CopyField(&soup->fields[f], num_vertices, num_cells, s));
  PetscCall(PetscMalloc1(3 * num_vertices, &s->vertices));
  PetscCall(PetscMalloc1(width * num_cells, &s->cells));
  PetscCall(PetscArraycpy(s->vertices, soup->vertices, 3 * num_vertices));
  PetscCall(PetscArraycpy(s->cells, soup->cells, width * num_cells));
  if (soup->density) {
    PetscCall(PetscMalloc1(num_cells + 1, &s->density));
    PetscCall(PetscArraycpy(s->density, soup->density, num_cells));
  }
  if (soup->edge_length) {
    PetscCall(PetscMalloc1(3 * num_cells + 1, &s->edge_length));
    PetscCall(PetscArraycpy(s->edge_length, soup->edge_length, 3 * num_cells));
  }
  *copy = s;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupDestroy(EqmSoup *soup)
{
  PetscFunctionBegin;
  if (!*soup) PetscFunctionReturn(0);
  PetscCall(PetscFree((*soup)->vertices));
  PetscCall(PetscFree((*soup)->cells));
  PetscCall(PetscFree((*soup)->density));
  PetscCall(PetscFree((*soup)->edge_length));
  PetscCall(PetscFree((*soup)->metadata));
  PetscCall(EqmMeshFieldsReset(&(*soup)->num_fields, &(*soup)->fields));
  PetscCall(PetscFree(*soup));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSerialMeshReset(EqmSerialMesh *serial)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(serial->vertices));
  PetscCall(PetscFree(serial->cells));
  PetscCall(PetscFree(serial->texture));
  PetscCall(PetscFree(serial->metadata));
  PetscCall(EqmMeshFieldsReset(&serial->num_fields, &serial->fields));
  memset(serial, 0, sizeof(*serial));
  PetscFunctionReturn(0);
}
