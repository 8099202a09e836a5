/* Vertices at one and the same place: sorted by a hash of their coordinates, to ranks and then to slots. */
#include "mesh/diagnose.h"
#include "base/exchange.h"

/* A vertex on its way to the rank of its hash, in PetscInts: its input number, then its coordinates. */
#define EQM_RECORD_COORDINATES 1
#define EQM_RECORD_WIDTH       (1 + 3 * (PetscInt)(sizeof(PetscReal) / sizeof(PetscInt)))

static uint64_t HashPoint(const PetscReal x[3])
{
  uint64_t hash = 0;

  for (int k = 0; k < 3; k++) {
    uint64_t bits;

    memcpy(&bits, &x[k], sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
    hash *= 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 32;
  }
  return hash;
}

static PetscErrorCode PackVertices(const EqmVicinity *vicinity, PetscInt *count, PetscInt *records,
                                   PetscMPIInt *destination)
{
  PetscFunctionBegin;
  *count = 0;
  for (PetscInt v = 0; v < vicinity->num_owned; v++) {
    PetscReal x[3];
    PetscInt *const record = records + EQM_RECORD_WIDTH * *count;

    if (vicinity->star_start[v] == vicinity->star_start[v + 1]) continue;
    for (int k = 0; k < 3; k++) x[k] = vicinity->position[3 * v + k] + 0.0; /* -0 and 0 are one place */
    if (PetscIsInfOrNanReal(x[0]) || PetscIsInfOrNanReal(x[1]) || PetscIsInfOrNanReal(x[2])) continue;
    record[0] = vicinity->input[v];
    memcpy(record + EQM_RECORD_COORDINATES, x, sizeof(x));
    destination[(*count)++] = (PetscMPIInt)(HashPoint(x) % (uint64_t)vicinity->size);
  }
  PetscFunctionReturn(0);
}

/* Records arrive in ascending input number, so that the one in a slot is the lowest of its place. */
static PetscErrorCode FindTwins(PetscInt count, const PetscInt *records, EqmFinding *finding)
{
  size_t num_slots = 16;
  PetscInt *slot;

  PetscFunctionBegin;
  while (num_slots < 2 * (size_t)count) num_slots *= 2;
  PetscCall(PetscMalloc1(num_slots, &slot));
  for (size_t s = 0; s < num_slots; s++) slot[s] = -1;
  for (PetscInt r = 0; r < count; r++) {
    const PetscInt *const record = records + EQM_RECORD_WIDTH * r;
    PetscReal x[3], y[3];
    size_t s;

    memcpy(x, record + EQM_RECORD_COORDINATES, sizeof(x));
    /* the low bits chose the rank */
    for (s = (HashPoint(x) >> 20) & (num_slots - 1); slot[s] >= 0; s = (s + 1) & (num_slots - 1)) {
      memcpy(y, records + EQM_RECORD_WIDTH * slot[s] + EQM_RECORD_COORDINATES, sizeof(y));
      if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) break;
    }
    if (slot[s] < 0)
      slot[s] = r;
    else
      EqmFindingAdd(finding, record[0], records[EQM_RECORD_WIDTH * slot[s]], -1, -1);
  }
  PetscCall(PetscFree(slot));
  PetscFunctionReturn(0);
}

/* Find vertices in use that lie exactly where one of a lower number lies: `where` is the vertex and the lowest one at
   its place. The findings are this rank's, not yet merged. Collective. */
PetscErrorCode EqmDiagnoseDuplicateVertices(const EqmVicinity *vicinity, EqmFinding *finding)
{
  PetscInt count, num_received, *records, *received;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(EQM_RECORD_WIDTH * vicinity->num_owned, &records));
  PetscCall(PetscMalloc1(vicinity->num_owned, &destination));
  PetscCall(PackVertices(vicinity, &count, records, destination));
  if (vicinity->size > 1) {
    PetscCall(EqmExchange(vicinity->comm, count, EQM_RECORD_WIDTH, destination, records, &num_received, &received));
    PetscCall(FindTwins(num_received, received, finding));
    PetscCall(PetscFree(received));
  } else {
    PetscCall(FindTwins(count, records, finding));
  }
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(records));
  PetscFunctionReturn(0);
}
