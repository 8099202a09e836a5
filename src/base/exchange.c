#include "base/exchange.h"
#include <string.h>

/* What one rank sends or receives: a run of records for each partner, in the order of ranks. */
typedef struct {
  PetscMPIInt num_ranks, *rank;
  PetscInt *count; /* records per partner */
  PetscInt total;
} Side;

/* The records in the order of their destinations, within one as given. */
static PetscErrorCode Pack(PetscMPIInt size, PetscInt num_records, size_t bytes, const PetscMPIInt *destination,
                           const char *records, Side *to, char **packed)
{
  PetscInt *place, start = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(size, &place));
  for (PetscInt r = 0; r < num_records; r++) place[destination[r]]++;
  to->num_ranks = 0;
  for (PetscMPIInt p = 0; p < size; p++) to->num_ranks += place[p] > 0;
  PetscCall(PetscMalloc2(to->num_ranks, &to->rank, to->num_ranks, &to->count));
  to->num_ranks = 0;
  for (PetscMPIInt p = 0; p < size; p++) {
    const PetscInt count = place[p];
    place[p] = start;
    start += count;
    if (count == 0) continue;
    to->rank[to->num_ranks] = p;
    to->count[to->num_ranks++] = count;
  }
  to->total = num_records;
  PetscCall(PetscMalloc1(bytes * (size_t)num_records, packed));
  for (PetscInt r = 0; r < num_records; r++)
    memcpy(*packed + bytes * (size_t)place[destination[r]]++, records + bytes * (size_t)r, bytes);
  PetscCall(PetscFree(place));
  PetscFunctionReturn(0);
}

/* Who sends how much to this rank: without a message to ranks that get nothing (Hoefler, Siebert, Lumsdaine, PPoPP
   2010). */
static PetscErrorCode Announce(MPI_Comm comm, const Side *to, Side *from)
{
  PetscFunctionBegin;
  PetscCall(PetscCommBuildTwoSided(comm, 1, MPIU_INT, to->num_ranks, to->rank, to->count, &from->num_ranks, &from->rank,
                                   &from->count));
  PetscCall(PetscSortMPIIntWithIntArray(from->num_ranks, from->rank, from->count));
  from->total = 0;
  for (PetscMPIInt k = 0; k < from->num_ranks; k++) from->total += from->count[k];
  PetscFunctionReturn(0);
}

/* The records themselves. */
static PetscErrorCode Transfer(MPI_Comm comm, size_t bytes, const Side *to, const char *packed, const Side *from,
                               char *arrived)
{
  MPI_Datatype record;
  MPI_Request *request;
  MPI_Comm own; /* PETSc's duplicate, whose tags are free */
  PetscMPIInt tag, width, count;
  size_t start = 0;

  PetscFunctionBegin;
  PetscCall(PetscCommDuplicate(comm, &own, &tag));
  PetscCall(PetscMPIIntCast((PetscInt)bytes, &width));
  PetscCallMPI(MPI_Type_contiguous(width, MPI_BYTE, &record));
  PetscCallMPI(MPI_Type_commit(&record));
  PetscCall(PetscMalloc1(to->num_ranks + from->num_ranks, &request));
  for (PetscMPIInt k = 0; k < from->num_ranks; start += (size_t)from->count[k++]) {
    PetscCall(PetscMPIIntCast(from->count[k], &count));
    PetscCallMPI(MPI_Irecv(arrived + bytes * start, count, record, from->rank[k], tag, own, &request[k]));
  }
  start = 0;
  for (PetscMPIInt k = 0; k < to->num_ranks; start += (size_t)to->count[k++]) {
    PetscCall(PetscMPIIntCast(to->count[k], &count));
    PetscCallMPI(
        MPI_Isend(packed + bytes * start, count, record, to->rank[k], tag, own, &request[from->num_ranks + k]));
  }
  PetscCallMPI(MPI_Waitall(to->num_ranks + from->num_ranks, request, MPI_STATUSES_IGNORE));
  PetscCall(PetscFree(request));
  PetscCallMPI(MPI_Type_free(&record));
  PetscCall(PetscCommDestroy(&own));
  PetscFunctionReturn(0);
}

/* Send each of `num_records` records of `bytes` bytes to its destination rank; *received (PetscFree it; `received`
   points to a pointer to records) holds what came, ordered by sender and, within a sender, as sent. Collective. */
PetscErrorCode EqmExchangeBytes(MPI_Comm comm, PetscInt num_records, size_t bytes, const PetscMPIInt *destination,
                                const void *records, PetscInt *num_received, void *received)
{
  PetscMPIInt size;
  char *packed, *arrived;
  Side to, from;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) { /* a copy, without the buffers of MPI's */
    *num_received = num_records;
    PetscCall(PetscMalloc1(bytes * (size_t)num_records, &arrived));
    PetscCall(PetscMemcpy(arrived, records, bytes * (size_t)num_records));
    *(void **)received = arrived;
    PetscFunctionReturn(0);
  }
  PetscCall(Pack(size, num_records, bytes, destination, records, &to, &packed));
  PetscCall(Announce(comm, &to, &from));
  PetscCall(PetscMalloc1(bytes * (size_t)from.total, &arrived));
  PetscCall(Transfer(comm, bytes, &to, packed, &from, arrived));
  PetscCall(PetscFree(packed));
  PetscCall(PetscFree2(to.rank, to.count));
  PetscCall(PetscFree(from.rank));
  PetscCall(PetscFree(from.count));
  *num_received = from.total;
  *(void **)received = arrived;
  PetscFunctionReturn(0);
}

/* The same for records of `width` integers. Collective. */
PetscErrorCode EqmExchange(MPI_Comm comm, PetscInt num_records, PetscInt width, const PetscMPIInt *destination,
                           const PetscInt *records, PetscInt *num_received, PetscInt **received)
{
  PetscFunctionBegin;
  PetscCall(EqmExchangeBytes(comm, num_records, (size_t)width * sizeof(PetscInt), destination, records, num_received,
                             received));
  PetscFunctionReturn(0);
}
