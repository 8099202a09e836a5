#include "base/exchange.h"
#include <string.h>

/* Send each of `num_records` records of `bytes` bytes to its destination rank; *received (PetscFree it; `received`
   points to a pointer to records) holds what came, ordered by sender and, within a sender, as sent. Collective. */
PetscErrorCode EqmExchangeBytes(MPI_Comm comm, PetscInt num_records, size_t bytes, const PetscMPIInt *destination,
                                const void *records, PetscInt *num_received, void *received)
{
  PetscMPIInt size, *send_count, *send_start, *receive_count, *receive_start;
  char *packed, *arrived;
  MPI_Datatype record_type;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  if (size == 1) { /* a copy, without the buffers of MPI's */
    *num_received = num_records;
    PetscCall(PetscMalloc1(bytes * (size_t)num_records, &arrived));
    PetscCall(PetscMemcpy(arrived, records, bytes * (size_t)num_records));
    *(void **)received = arrived;
    PetscFunctionReturn(0);
  }
  PetscCall(PetscCalloc4(size, &send_count, size + 1, &send_start, size, &receive_count, size + 1, &receive_start));
  for (PetscInt r = 0; r < num_records; r++) send_count[destination[r]]++;
  for (PetscMPIInt p = 0; p < size; p++) send_start[p + 1] = send_start[p] + send_count[p];
  PetscCall(PetscMalloc1(bytes * (size_t)num_records, &packed));
  for (PetscInt r = 0; r < num_records; r++) {
    memcpy(packed + bytes * (size_t)send_start[destination[r]]++, (const char *)records + bytes * (size_t)r, bytes);
  }
  for (PetscMPIInt p = size; p > 0; p--) send_start[p] = send_start[p - 1];
  send_start[0] = 0;
  PetscCallMPI(MPI_Alltoall(send_count, 1, MPI_INT, receive_count, 1, MPI_INT, comm));
  for (PetscMPIInt p = 0; p < size; p++) receive_start[p + 1] = receive_start[p] + receive_count[p];
  *num_received = receive_start[size];
  PetscCall(PetscMalloc1(bytes * (size_t)*num_received, &arrived));
  PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)bytes, MPI_BYTE, &record_type));
  PetscCallMPI(MPI_Type_commit(&record_type));
  PetscCallMPI(MPI_Alltoallv(packed, send_count, send_start, record_type, arrived, receive_count, receive_start,
                             record_type, comm));
  PetscCallMPI(MPI_Type_free(&record_type));
  PetscCall(PetscFree(packed));
  PetscCall(PetscFree4(send_count, send_start, receive_count, receive_start));
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
