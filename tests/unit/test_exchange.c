/* Records between ranks: each arrives once, by sender and in the order in which it was sent, also where most ranks have
   nothing for each other, where one rank gets all, and where nobody sends. */
#include "support/testing.h"
#include "base/exchange.h"

enum { WIDTH = 3 };

typedef PetscMPIInt (*Rule)(PetscMPIInt rank, PetscInt k, PetscMPIInt size); /* where the k-th record goes */

static PetscMPIInt ToFirst(PetscMPIInt rank, PetscInt k, PetscMPIInt size)
{
  (void)rank;
  (void)k;
  (void)size;
  return 0;
}

static PetscMPIInt ToNext(PetscMPIInt rank, PetscInt k, PetscMPIInt size)
{
  (void)k;
  return (rank + 1) % size;
}

static PetscMPIInt ToAll(PetscMPIInt rank, PetscInt k, PetscMPIInt size)
{
  return (PetscMPIInt)((7 * k + rank) % size);
}

/* `per_rank` times the rank records each: sender, number, a square. */
static PetscErrorCode TestRule(Rule rule, PetscInt per_rank)
{
  PetscMPIInt rank, size, *destination;
  PetscInt *records, *received, num, expected = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  num = per_rank * rank; /* the first has none */
  PetscCall(PetscMalloc2(num, &destination, WIDTH * num, &records));
  for (PetscInt k = 0; k < num; k++) {
    destination[k] = rule(rank, k, size);
    records[WIDTH * k] = rank;
    records[WIDTH * k + 1] = k;
    records[WIDTH * k + 2] = k * k;
  }
  PetscCall(EqmExchange(PETSC_COMM_WORLD, num, WIDTH, destination, records, &num, &received));
  for (PetscMPIInt sender = 0; sender < size; sender++) {
    for (PetscInt k = 0; k < per_rank * sender; k++) {
      if (rule(sender, k, size) != rank) continue;
      CHECK(expected < num && received[WIDTH * expected] == sender && received[WIDTH * expected + 1] == k &&
                received[WIDTH * expected + 2] == k * k,
            "record %d of rank %d is not the next one on rank %d", (int)k, sender, rank);
      expected++;
    }
  }
  CHECK(expected == num, "rank %d got %d records, not %d", rank, (int)num, (int)expected);
  PetscCall(PetscFree2(destination, records));
  PetscCall(PetscFree(received));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  static const Rule rules[] = {ToFirst, ToNext, ToAll};

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (size_t k = 0; k < sizeof(rules) / sizeof(rules[0]); k++) {
    PetscCall(TestRule(rules[k], 50));
    PetscCall(TestRule(rules[k], 0));
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
