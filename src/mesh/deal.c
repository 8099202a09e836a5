/* A mesh that one rank holds, dealt to all in slabs, and gathered again. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "mesh/fields.h"
#include <string.h>

enum { TAG_VERTICES = 1, TAG_CELLS = 2, TAG_FIELD = 3 };

PetscInt EqmSlabStart(PetscInt total, PetscMPIInt rank, PetscMPIInt size)
{
  return (PetscInt)((PetscInt64)total / size * rank + PetscMin(rank, (PetscInt64)total % size));
}

/* The balanced slabs: start[r] is the first row of rank r, start[size] the total. */
static PetscErrorCode BalancedStarts(MPI_Comm comm, PetscInt total, PetscInt **start)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size + 1, start));
  for (PetscMPIInt r = 0; r <= size; ++r) (*start)[r] = EqmSlabStart(total, r, size);
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

/* Move rows between rank 0, whose `all` holds all of them, and the slabs of the others; `deal` is the direction from
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

/* The text that rank 0 holds, or NULL, to all ranks. Collective. */
static PetscErrorCode ShareText(MPI_Comm comm, char **text)
{
  PetscMPIInt rank, length = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0 && *text) PetscCall(PetscMPIIntCast((PetscInt)strlen(*text) + 1, &length));
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, 0, comm));
  if (!length) PetscFunctionReturn(0);
  if (rank != 0) PetscCall(PetscMalloc1(length, text));
  PetscCallMPI(MPI_Bcast(*text, length, MPI_CHAR, 0, comm));
  PetscFunctionReturn(0);
}

/* Deal the rows that rank 0 holds; its own slab is the beginning of its array, which shrinks. */
static PetscErrorCode Deal(MPI_Comm comm, PetscInt total, MPI_Datatype number, PetscInt width, PetscMPIInt tag,
                           void *all, PetscInt *num_local, void **slab)
{
  PetscInt *start;
  PetscMPIInt rank, number_bytes;
  size_t bytes;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Type_size(number, &number_bytes));
  PetscCall(BalancedStarts(comm, total, &start));
  *num_local = start[rank + 1] - start[rank];
  bytes = (size_t)number_bytes * (size_t)width * (size_t)*num_local;
  if (rank == 0)
    *slab = all;
  else
    PetscCall(PetscMalloc(bytes, slab));
  PetscCall(Transfer(comm, PETSC_TRUE, number, width, tag, start, *slab, *slab));
  if (rank == 0 && bytes > 0) PetscCall(PetscRealloc(bytes, slab));
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

/* What a field is, without its values. */
typedef struct {
  char name[EQM_FIELD_NAME];
  PetscInt on_cells, width;
} FieldKind;

/* Deal the fields of rank 0, one after the other. Collective. */
static PetscErrorCode DealFields(MPI_Comm comm, EqmSerialMesh *mesh, EqmSoup soup)
{
  PetscInt num = mesh->num_fields, rows;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&num, 1, MPIU_INT, 0, comm));
  if (num) PetscCall(PetscCalloc1(num, &soup->fields));
  soup->num_fields = num;
  for (PetscInt f = 0; f < num; ++f) {
    const EqmMeshField *const all = mesh->num_fields ? &mesh->fields[f] : NULL;
    EqmMeshField *const field = &soup->fields[f];
    FieldKind kind = {.on_cells = all ? all->on_cells : 0, .width = all ? all->width : 0};

    if (all) PetscCall(PetscStrncpy(kind.name, all->name, sizeof(kind.name)));
    PetscCallMPI(MPI_Bcast(&kind, sizeof(kind), MPI_BYTE, 0, comm));
    PetscCall(PetscStrncpy(field->name, kind.name, sizeof(field->name)));
    field->on_cells = kind.on_cells ? PETSC_TRUE : PETSC_FALSE;
    field->width = kind.width;
    PetscCall(Deal(comm, field->on_cells ? soup->num_cells : soup->num_vertices, MPIU_REAL, kind.width, TAG_FIELD,
                   all ? all->values : NULL, &rows, (void **)&field->values));
  }
  PetscCall(PetscFree(mesh->fields)); /* their values are the soup's now */
  mesh->num_fields = 0;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupCreateFromRoot(MPI_Comm comm, EqmSerialMesh *serial, const char *file, EqmSoup *soup)
{
  EqmSerialMesh mesh = {0};
  PetscInt shape[3], num_vertices, num_cells;
  void *vertices, *cells;
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
  PetscCall(Deal(comm, shape[0], MPIU_REAL, 3, TAG_VERTICES, mesh.vertices, &num_vertices, &vertices));
  PetscCall(Deal(comm, shape[1], MPIU_INT, shape[2], TAG_CELLS, mesh.cells, &num_cells, &cells));
  PetscCall(EqmMeshFieldsTakeTexture(&mesh));
  PetscCall(ShareText(comm, &mesh.metadata));
  PetscCallMPI(MPI_Bcast(mesh.note, EQM_SOUP_NOTE, MPI_CHAR, 0, comm));
  PetscCallMPI(MPI_Bcast(mesh.left, EQM_SOUP_NOTE, MPI_CHAR, 0, comm));
  PetscCall(EqmSoupCreateFromSlabs(comm, shape[2], num_vertices, vertices, num_cells, cells, file, soup));
  PetscCall(PetscStrncpy((*soup)->note, mesh.note, EQM_SOUP_NOTE));
  PetscCall(PetscStrncpy((*soup)->left, mesh.left, EQM_SOUP_NOTE));
  (*soup)->metadata = mesh.metadata;
  PetscCall(DealFields(comm, &mesh, *soup));
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

/* Bring the values of all fields together on rank 0, whose slab is the beginning. Collective. */
static PetscErrorCode GatherFields(EqmSoup soup, PetscBool on_cells, const PetscInt *start, EqmSerialMesh *serial)
{
  const size_t total = (size_t)(on_cells ? soup->num_cells : soup->num_vertices);
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  for (PetscInt f = 0; f < soup->num_fields; ++f) {
    const EqmMeshField *const field = &soup->fields[f];
    PetscReal *values = NULL;

    if (field->on_cells != on_cells) continue;
    if (rank == 0) {
      PetscCall(EqmMeshFieldsAdd(&serial->num_fields, &serial->fields, field, total, &values));
      PetscCall(PetscArraycpy(values, field->values, (size_t)start[1] * (size_t)field->width));
    }
    PetscCall(Transfer(soup->comm, PETSC_FALSE, MPIU_REAL, field->width, TAG_FIELD, start, values, field->values));
  }
  PetscFunctionReturn(0);
}

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
    PetscCall(PetscStrallocpy(soup->metadata, &serial->metadata));
    PetscCall(PetscMalloc1(3 * (size_t)soup->num_vertices, &serial->vertices));
    PetscCall(PetscMalloc1(width * (size_t)soup->num_cells, &serial->cells));
    PetscCall(PetscArraycpy(serial->vertices, soup->vertices, 3 * (size_t)soup->vertex_end));
    PetscCall(PetscArraycpy(serial->cells, soup->cells, width * (size_t)soup->cell_end));
  }
  PetscCall(GivenStarts(soup->comm, soup->vertex_end, &start));
  PetscCall(Transfer(soup->comm, PETSC_FALSE, MPIU_REAL, 3, TAG_VERTICES, start, serial->vertices, soup->vertices));
  PetscCall(GatherFields(soup, PETSC_FALSE, start, serial));
  PetscCall(PetscFree(start));
  PetscCall(GivenStarts(soup->comm, soup->cell_end, &start));
  PetscCall(Transfer(soup->comm, PETSC_FALSE, MPIU_INT, soup->cell_size, TAG_CELLS, start, serial->cells, soup->cells));
  PetscCall(GatherFields(soup, PETSC_TRUE, start, serial));
  PetscCall(PetscFree(start));
  PetscCall(EqmMeshFieldsGiveTexture(serial));
  PetscFunctionReturn(0);
}
