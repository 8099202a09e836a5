/* Tags of the vertices of all ranks. Where they are not consecutive, a tag and its vertex meet those who look for it on
   the rank that the tag modulo the number of ranks is. */
#include "tagmap.h"
#include "base/exchange.h"
#include "base/sort.h"

typedef struct {
  PetscInt64 tag, value; /* number of the vertex, or the rank that asks for it */
} Record;

static int CompareRecords(const void *left, const void *right)
{
  const PetscInt64 a = ((const Record *)left)->tag, b = ((const Record *)right)->tag;

  return (a > b) - (a < b);
}

static void SortRecords(PetscInt num, Record *records)
{
  EqmSort(records, (size_t)num, sizeof(*records), CompareRecords);
}

PetscErrorCode EqmTagMapShare(MPI_Comm comm, EqmTagMap *map, PetscBool *consecutive, PetscBool *success)
{
  const PetscInt64 mine = (PetscInt64)map->count;
  PetscInt64 end, total, first[2];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCall(MPIU_Allreduce(&mine, &total, 1, MPIU_INT64, MPI_SUM, comm));
  *success = total <= PETSC_MAX_INT ? PETSC_TRUE : PETSC_FALSE;
  /* the tag of the very first vertex, and its negative; nobody's where a rank's tags have gaps */
  first[0] = !mine ? PETSC_MAX_INT : map->consecutive ? map->first - (end - mine) : -1;
  first[1] = !mine ? PETSC_MAX_INT : map->consecutive ? -first[0] : -1;
  if (mine && map->consecutive && (first[0] < 0 || first[0] > PETSC_MAX_INT)) first[0] = first[1] = -1;
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, first, 2, MPIU_INT64, MPI_MIN, comm));
  *consecutive = total && first[0] >= 0 && first[0] == -first[1] ? PETSC_TRUE : PETSC_FALSE;
  if (!*consecutive) PetscFunctionReturn(0);
  PetscCall(EqmTagMapReset(map));
  *map = (EqmTagMap){.count = (size_t)total, .first = first[0], .consecutive = PETSC_TRUE};
  PetscFunctionReturn(0);
}

/* Records to the ranks that their tags name. Collective. */
static PetscErrorCode Send(MPI_Comm comm, PetscInt num, const Record *records, PetscInt *num_received,
                           Record **received)
{
  PetscMPIInt size, *destination;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(num, &destination));
  for (PetscInt i = 0; i < num; ++i) destination[i] = (PetscMPIInt)(records[i].tag % size);
  PetscCall(EqmExchangeBytes(comm, num, sizeof(Record), destination, records, num_received, received));
  PetscCall(PetscFree(destination));
  PetscFunctionReturn(0);
}

/* Bring each tag of a vertex to where it is looked up, sorted. Collective. */
static PetscErrorCode Announce(MPI_Comm comm, const EqmTagMap *map, PetscInt *num_known, Record **known,
                               PetscBool *success)
{
  const PetscInt64 mine = (PetscInt64)map->count;
  PetscInt64 end;
  Record *records;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&mine, &end, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCall(PetscMalloc1(map->count, &records));
  for (PetscInt64 i = 0; i < mine; ++i) records[i] = (Record){map->tag[i], end - mine + i};
  PetscCall(Send(comm, (PetscInt)mine, records, num_known, known));
  PetscCall(PetscFree(records));
  SortRecords(*num_known, *known);
  for (PetscInt i = 1; i < *num_known; ++i) {
    if ((*known)[i].tag == (*known)[i - 1].tag) *success = PETSC_FALSE;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, success, 1, MPIU_BOOL, MPI_LAND, comm));
  PetscFunctionReturn(0);
}

/* Ask for the tags, each once. Collective. */
static PetscErrorCode Ask(MPI_Comm comm, PetscInt64 num_named, PetscInt64 *named, PetscInt *num_asked, Record **asked)
{
  PetscMPIInt rank;
  PetscInt num = 0;
  PetscCount count = 0;
  Record *records;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscSortInt64(num_named, named));
  for (PetscInt64 i = 0; i < num_named; ++i) {
    if (named[i] >= 0 && (i == 0 || named[i] != named[i - 1])) named[count++] = named[i];
  }
  PetscCall(PetscMalloc1(count, &records));
  for (; num < count; ++num) records[num] = (Record){named[num], rank};
  PetscCall(Send(comm, num, records, num_asked, asked));
  PetscCall(PetscFree(records));
  PetscFunctionReturn(0);
}

/* Answer who asks for a tag that a vertex has. Both lists are sorted. Collective. */
static PetscErrorCode Answer(MPI_Comm comm, PetscInt num_known, const Record *known, PetscInt num_asked,
                             const Record *asked, PetscInt *num_answers, Record **answers)
{
  PetscMPIInt *destination;
  PetscInt num = 0, k = 0;
  Record *records;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num_asked, &destination, num_asked, &records));
  for (PetscInt i = 0; i < num_asked; ++i) {
    while (k < num_known && known[k].tag < asked[i].tag) ++k;
    if (k == num_known || known[k].tag != asked[i].tag) continue;
    destination[num] = (PetscMPIInt)asked[i].value;
    records[num++] = known[k];
  }
  PetscCall(EqmExchangeBytes(comm, num, sizeof(Record), destination, records, num_answers, answers));
  PetscCall(PetscFree2(destination, records));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmTagMapShareNamed(MPI_Comm comm, EqmTagMap *map, PetscInt64 num_named, PetscInt64 *named,
                                   PetscBool *success)
{
  PetscInt num_known, num_asked, num_answers;
  Record *known, *asked, *answers;

  PetscFunctionBegin;
  *success = PETSC_TRUE;
  PetscCall(Announce(comm, map, &num_known, &known, success));
  PetscCall(EqmTagMapReset(map));
  PetscCall(Ask(comm, num_named, named, &num_asked, &asked));
  SortRecords(num_asked, asked);
  PetscCall(Answer(comm, num_known, known, num_asked, asked, &num_answers, &answers));
  PetscCall(PetscFree(known));
  PetscCall(PetscFree(asked));
  SortRecords(num_answers, answers);
  map->count = map->capacity = (size_t)num_answers;
  PetscCall(PetscMalloc1(num_answers, &map->tag));
  PetscCall(PetscMalloc1(num_answers, &map->number));
  for (PetscInt i = 0; i < num_answers; ++i) {
    map->tag[i] = answers[i].tag;
    map->number[i] = (PetscInt)answers[i].value;
  }
  PetscCall(PetscFree(answers));
  PetscFunctionReturn(0);
}
