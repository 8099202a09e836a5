/* The mesh of a file, dealt to the ranks in contiguous slabs of vertices and of cells. */
#include "mesh/build.h"
#include "base/checksum.h"
#include <string.h>

enum { TAG_VERTICES = 1, TAG_CELLS = 2 };

/* First row of a rank's share of `total` rows: contiguous, in rank order, sizes that differ by one at most. */
static PetscInt ShareStart(PetscInt total, PetscMPIInt rank, PetscMPIInt size)
{
  return (PetscInt)((PetscInt64)total / size * rank + PetscMin(rank, (PetscInt64)total % size));
}

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

/* EqmSoupCreateFromSlabs - wrap slabs that every rank already holds.

   Collective. Slabs are contiguous in rank order.
   vertices - 3 * num_local_vertices, cells - cell_size * num_local_cells global vertex numbers; PetscMalloc'ed (or NULL
   where empty) and taken over, also after a failure. Errors: EQM_ERR_IO if the mesh has more vertices or cells than
   PetscInt can count. */
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

/* The balanced slabs: start[r] is the first row of rank r, start[size] the total. */
static PetscErrorCode BalancedStarts(MPI_Comm comm, PetscInt total, PetscInt **start)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size + 1, start));
  for (PetscMPIInt r = 0; r <= size; ++r) (*start)[r] = ShareStart(total, r, size);
  PetscFunctionReturn(0);
}

/* Send or receive the rows of the others' slabs (on rank 0, in `all`), or those of this rank (`slab`). */
static PetscErrorCode MoveRows(MPI_Comm comm, PetscBool deal, MPI_Datatype row, size_t row_bytes, PetscMPIInt tag,
                               const PetscInt *start, char *all, char *slab)
{
  PetscMPIInt rank, size, count, num_requests = 0;
  MPI_Request *requests;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size, &requests));
  for (PetscMPIInt r = 1; r < size; ++r) {
    char *rows = rank == 0 ? all + (size_t)start[r] * row_bytes : slab;
    const PetscMPIInt partner = rank == 0 ? r : 0;

    if (rank != 0 && rank != r) continue;
    PetscCall(PetscMPIIntCast(start[r + 1] - start[r], &count));
    if ((rank == 0) == (deal == PETSC_TRUE)) {
      PetscCallMPI(MPI_Isend(rows, count, row, partner, tag, comm, &requests[num_requests++]));
    } else {
      PetscCallMPI(MPI_Irecv(rows, count, row, partner, tag, comm, &requests[num_requests++]));
    }
  }
  PetscCallMPI(MPI_Waitall(num_requests, requests, MPI_STATUSES_IGNORE));
  PetscCall(PetscFree(requests));
  PetscFunctionReturn(0);
}

/* Move rows between rank 0, which has room for `all` of them, and the slabs of the others; `deal` is the direction from
   rank 0. A row of `width` numbers is one item for MPI, whose counts are 32-bit. The slab of rank 0 is not touched. */
static PetscErrorCode Transfer(MPI_Comm comm, PetscBool deal, MPI_Datatype number, PetscInt width, PetscMPIInt tag,
                               const PetscInt *start, void *all, void *slab)
{
  MPI_Datatype row;
  PetscMPIInt row_bytes;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)width, number, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCallMPI(MPI_Type_size(row, &row_bytes));
  PetscCall(MoveRows(comm, deal, row, (size_t)row_bytes, tag, start, (char *)all, (char *)slab));
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(0);
}

/* Deal the vertices that rank 0 holds; its own slab is the beginning of its array, which shrinks. */
static PetscErrorCode DealVertices(MPI_Comm comm, PetscInt total, PetscReal **all, PetscInt *num_local,
                                   PetscReal **slab)
{
  PetscInt *start;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(BalancedStarts(comm, total, &start));
  *num_local = start[rank + 1] - start[rank];
  if (rank == 0) {
    *slab = *all;
    *all = NULL;
  } else {
    PetscCall(PetscMalloc1(3 * (size_t)*num_local, slab));
  }
  PetscCall(Transfer(comm, PETSC_TRUE, MPIU_REAL, 3, TAG_VERTICES, start, *slab, *slab));
  if (rank == 0 && *num_local) PetscCall(PetscRealloc(3 * (size_t)*num_local * sizeof(PetscReal), slab));
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

/* The same for cells. */
static PetscErrorCode DealCells(MPI_Comm comm, PetscInt total, PetscInt cell_size, PetscInt **all, PetscInt *num_local,
                                PetscInt **slab)
{
  PetscInt *start;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(BalancedStarts(comm, total, &start));
  *num_local = start[rank + 1] - start[rank];
  if (rank == 0) {
    *slab = *all;
    *all = NULL;
  } else {
    PetscCall(PetscMalloc1((size_t)cell_size * (size_t)*num_local, slab));
  }
  PetscCall(Transfer(comm, PETSC_TRUE, MPIU_INT, cell_size, TAG_CELLS, start, *slab, *slab));
  if (rank == 0 && *num_local) {
    PetscCall(PetscRealloc((size_t)cell_size * (size_t)*num_local * sizeof(PetscInt), slab));
  }
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

/* EqmSoupCreateFromRoot - deal a mesh that rank 0 holds to all ranks, in balanced contiguous slabs.

   Collective. serial - on rank 0 the mesh, whose arrays are taken over and are gone afterwards; not looked at
   elsewhere. */
PetscErrorCode EqmSoupCreateFromRoot(MPI_Comm comm, EqmSerialMesh *serial, const char *file, EqmSoup *soup)
{
  EqmSerialMesh mesh = {0};
  PetscInt shape[3], num_vertices = 0, num_cells = 0, *cells = NULL;
  PetscReal *vertices = NULL;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    mesh = *serial;
    memset(serial, 0, sizeof(*serial));
  }
  shape[0] = mesh.num_vertices;
  shape[1] = mesh.num_cells;
  shape[2] = mesh.cell_size;
  PetscCallMPI(MPI_Bcast(shape, 3, MPIU_INT, 0, comm));
  PetscCall(DealVertices(comm, shape[0], &mesh.vertices, &num_vertices, &vertices));
  PetscCall(DealCells(comm, shape[1], shape[2], &mesh.cells, &num_cells, &cells));
  PetscCall(EqmSoupCreateFromSlabs(comm, shape[2], num_vertices, vertices, num_cells, cells, file, soup));
  PetscFunctionReturn(0);
}

/* The slabs as they are: start[r] is the first row of rank r. */
static PetscErrorCode GivenStarts(MPI_Comm comm, PetscInt slab_end, PetscInt **start)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size + 1, start));
  (*start)[0] = 0;
  PetscCallMPI(MPI_Allgather(&slab_end, 1, MPIU_INT, *start + 1, 1, MPIU_INT, comm));
  PetscFunctionReturn(0);
}

/* EqmSoupGather - the whole mesh on rank 0, for formats that one rank must write.

   Collective. serial - filled on rank 0, empty elsewhere; EqmSerialMeshReset frees it. */
PetscErrorCode EqmSoupGather(EqmSoup soup, EqmSerialMesh *serial)
{
  const size_t width = (size_t)soup->cell_size;
  PetscInt *start;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  memset(serial, 0, sizeof(*serial));
  if (rank == 0) {
    serial->num_vertices = soup->num_vertices;
    serial->num_cells = soup->num_cells;
    serial->cell_size = soup->cell_size;
    PetscCall(PetscMalloc1(3 * (size_t)soup->num_vertices, &serial->vertices));
    PetscCall(PetscMalloc1(width * (size_t)soup->num_cells, &serial->cells));
    PetscCall(PetscArraycpy(serial->vertices, soup->vertices, 3 * (size_t)soup->vertex_end));
    PetscCall(PetscArraycpy(serial->cells, soup->cells, width * (size_t)soup->cell_end));
  }
  PetscCall(GivenStarts(soup->comm, soup->vertex_end, &start));
  PetscCall(Transfer(soup->comm, PETSC_FALSE, MPIU_REAL, 3, TAG_VERTICES, start, serial->vertices, soup->vertices));
  PetscCall(PetscFree(start));
  PetscCall(GivenStarts(soup->comm, soup->cell_end, &start));
  PetscCall(Transfer(soup->comm, PETSC_FALSE, MPIU_INT, soup->cell_size, TAG_CELLS, start, serial->cells, soup->cells));
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

/* EqmSoupCopy - a soup of its own with the same mesh, slabs, density and provenance.

   Collective. copy - to be freed with EqmSoupDestroy. Errors: out of memory. */
PetscErrorCode EqmSoupCopy(EqmSoup soup, EqmSoup *copy)
{
  const size_t num_vertices = (size_t)(soup->vertex_end - soup->vertex_start);
  const size_t num_cells = (size_t)(soup->cell_end - soup->cell_start), width = (size_t)soup->cell_size;
  EqmSoup s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  *s = *soup;
  s->density = s->edge_length = NULL;
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

/* EqmSoupDestroy - free a soup. Collective; a NULL soup is fine. */
PetscErrorCode EqmSoupDestroy(EqmSoup *soup)
{
  PetscFunctionBegin;
  if (!*soup) PetscFunctionReturn(0);
  PetscCall(PetscFree((*soup)->vertices));
  PetscCall(PetscFree((*soup)->cells));
  PetscCall(PetscFree((*soup)->density));
  PetscCall(PetscFree((*soup)->edge_length));
  PetscCall(PetscFree(*soup));
  PetscFunctionReturn(0);
}

/* EqmSerialMeshReset - free the arrays of a mesh and make it empty. Not collective. */
PetscErrorCode EqmSerialMeshReset(EqmSerialMesh *serial)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(serial->vertices));
  PetscCall(PetscFree(serial->cells));
  memset(serial, 0, sizeof(*serial));
  PetscFunctionReturn(0);
}
