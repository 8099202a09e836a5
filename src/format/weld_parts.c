/* Equal points of all ranks become one: each distinct point of a rank goes to the rank that its hash names, where equal
   ones meet and learn which of them is the first. */
#include "weld.h"
#include "base/exchange.h"
#include "base/rows.h"

#include <string.h>

typedef struct {
  PetscReal x[3];
  PetscInt number; /* among the points of all ranks, in their order */
} Record;

/* Send this rank's points to where they meet others. Collective. */
static PetscErrorCode SendPoints(MPI_Comm comm, PetscInt num, PetscInt start, const PetscReal *points,
                                 PetscInt *num_received, Record **received)
{
  PetscMPIInt size, *destination;
  Record *records;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(num, &destination));
  PetscCall(PetscCalloc1(num, &records));
  for (PetscInt i = 0; i < num; ++i) {
    memcpy(records[i].x, points + 3 * (size_t)i, sizeof(records[i].x));
    records[i].number = start + i;
    destination[i] = (PetscMPIInt)((EqmWeldHash(records[i].x) >> 32) % (uint64_t)size);
  }
  PetscCall(EqmExchangeBytes(comm, num, sizeof(Record), destination, records, num_received, received));
  PetscCall(PetscFree(records));
  PetscCall(PetscFree(destination));
  PetscFunctionReturn(0);
}

/* Per record the number of the first point that equals it. They come in the order of their numbers. */
static PetscErrorCode FindFirst(PetscInt num, const Record *records, PetscInt *first)
{
  size_t num_distinct;
  PetscReal *x;
  PetscInt *number_of_first;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * (size_t)num, &x));
  for (PetscInt i = 0; i < num; ++i) memcpy(x + 3 * (size_t)i, records[i].x, sizeof(records[i].x));
  PetscCall(EqmWeld((size_t)num, x, &num_distinct, first));
  PetscCall(PetscFree(x));
  PetscCall(PetscMalloc1(num_distinct, &number_of_first));
  for (PetscInt i = num; i-- > 0;) number_of_first[first[i]] = records[i].number;
  for (PetscInt i = 0; i < num; ++i) first[i] = number_of_first[first[i]];
  PetscCall(PetscFree(number_of_first));
  PetscFunctionReturn(0);
}

/* For each of this rank's points, `start` the number of its first one, the number of the first that equals it.
   Collective. */
static PetscErrorCode FirstOfAll(MPI_Comm comm, PetscInt num, PetscInt start, const PetscReal *points, PetscInt *first)
{
  PetscInt num_received, *first_of_received, *numbers;
  Record *received;

  PetscFunctionBegin;
  PetscCall(SendPoints(comm, num, start, points, &num_received, &received));
  PetscCall(PetscMalloc2(num_received, &first_of_received, num_received, &numbers));
  PetscCall(FindFirst(num_received, received, first_of_received));
  for (PetscInt i = 0; i < num_received; ++i) numbers[i] = received[i].number;
  PetscCall(PetscFree(received));
  PetscCall(EqmPutRows(comm, num, num_received, numbers, MPIU_INT, 1, first_of_received, first));
  PetscCall(PetscFree2(first_of_received, numbers));
  PetscFunctionReturn(0);
}

/* Keep the points that are first, and number them: `first` becomes the number of each point's first one. Collective. */
static PetscErrorCode NumberFirst(MPI_Comm comm, PetscInt num, PetscInt start, PetscReal *points, PetscInt *first,
                                  size_t *num_kept)
{
  PetscInt kept = 0, end, *number, *of_first;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(num, &number, num, &of_first));
  for (PetscInt i = 0; i < num; ++i) {
    if (first[i] != start + i) continue;
    memmove(points + 3 * (size_t)kept, points + 3 * (size_t)i, 3 * sizeof(PetscReal));
    number[i] = kept++;
  }
  PetscCallMPI(MPI_Scan(&kept, &end, 1, MPIU_INT, MPI_SUM, comm));
  for (PetscInt i = 0; i < num; ++i) number[i] += end - kept;
  *num_kept = (size_t)kept;
  PetscCall(EqmFetchRows(comm, num, num, first, MPIU_INT, 1, number, of_first));
  PetscCall(PetscArraycpy(first, of_first, num));
  PetscCall(PetscFree2(number, of_first));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmWeldParts(MPI_Comm comm, size_t *num_points, PetscReal *points, PetscInt *number, PetscBool *success)
{
  const size_t given = *num_points;
  size_t num_distinct;
  PetscInt64 mine, end, total;
  PetscInt *first;

  PetscFunctionBegin;
  PetscCall(EqmWeld(given, points, &num_distinct, number));
  mine = (PetscInt64)num_distinct;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCall(MPIU_Allreduce(&mine, &total, 1, MPIU_INT64, MPI_SUM, comm));
  *success = total <= PETSC_MAX_INT ? PETSC_TRUE : PETSC_FALSE;
  if (!*success) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(num_distinct, &first));
  PetscCall(FirstOfAll(comm, (PetscInt)mine, (PetscInt)(end - mine), points, first));
  PetscCall(NumberFirst(comm, (PetscInt)mine, (PetscInt)(end - mine), points, first, num_points));
  for (size_t i = 0; i < given; ++i) number[i] = first[number[i]];
  PetscCall(PetscFree(first));
  PetscFunctionReturn(0);
}
