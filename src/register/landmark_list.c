/* Landmarks from a CSV file. */
#include "register/landmark_list.h"
#include "format/format.h"
#include "format/input.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_COLUMNS = 4 };

/* The rows of the file, on rank 0. */
typedef struct {
  EqmInput in;
  PetscInt num, most, columns;
  PetscReal *values; /* MOST_COLUMNS each */
} Table;

/* The numbers of a line; -1 where something else stands there. */
static int ReadNumbers(const EqmInput *in, PetscReal values[MOST_COLUMNS])
{
  const char *c = in->cursor, *end = c;
  int count = 0;

  while (end < in->end && *end != '\n' && *end != '\r') ++end;
  while (end > c && EqmIsBlank(end[-1])) --end;
  while (c < end) {
    while (c < end && EqmIsBlank(*c)) ++c;
    if (count == MOST_COLUMNS) return -1;
    c = EqmParseReal(c, end, &values[count++]);
    if (!c) return -1;
    while (c < end && EqmIsBlank(*c)) ++c;
    if (c < end && *c != ',' && *c != ';' && *c != '\t') return -1;
    if (c < end && ++c == end) return -1;
  }
  return count;
}

static PetscErrorCode ParseRow(Table *table)
{
  PetscReal values[MOST_COLUMNS] = {0.};
  const int count = ReadNumbers(&table->in, values);

  if (count < 2)
    return EqmReject(
        &table->in, EQM_ERR_IO,
        "a landmark is a vertex of A and a vertex of B (two numbers), or a vertex of A and a point (three or "
        "four numbers)");
  if (table->columns == 0) table->columns = count;
  if (count != table->columns)
    return EqmReject(&table->in, EQM_ERR_IO, "%d numbers, where the lines before have %d", count, (int)table->columns);
  if (table->num == table->most) {
    table->most = PetscMax(64, 2 * table->most);
    EqmTry(PetscRealloc(sizeof(PetscReal) * MOST_COLUMNS * (size_t)table->most, &table->values));
  }
  memcpy(table->values + MOST_COLUMNS * table->num++, values, sizeof(values));
  return 0;
}

static PetscErrorCode ParseTable(Table *table)
{
  EqmInput *const in = &table->in;
  PetscReal values[MOST_COLUMNS];

  EqmSkipMark(in);
  if (ReadNumbers(in, values) >= 2)
    return EqmReject(in, EQM_ERR_IO, "the first line is numbers; it must be a header, such as \"vertex_a,vertex_b\"");
  for (EqmSkipLine(in); in->cursor < in->end; EqmSkipLine(in)) {
    if (!EqmAtLineEnd(in)) EqmTry(ParseRow(table));
  }
  return table->num ? 0 : EqmReject(in, EQM_ERR_IO, "there is no landmark in it");
}

static PetscErrorCode ReadOnRoot(const char *file, Table *table, char *error, size_t length)
{
  char *bytes, reason[EQM_MESSAGE_MAX / 2] = "";
  size_t size;
  PetscErrorCode code = EqmFormatLoadBytes(file, &bytes, &size, error, length);

  if (!code) {
    EqmInputOpen(&table->in, bytes, size, reason, sizeof(reason));
    code = ParseTable(table);
    if (code) (void)snprintf(error, length, "%s: %s", file, reason);
  }
  free(bytes);
  return code;
}

/* A whole number between 0 and count - 1? */
static PetscBool IsVertex(PetscReal value, PetscInt count)
{
  return (PetscBool)(value >= 0. && value < count && value == PetscFloorReal(value));
}

static PetscErrorCode Check(MPI_Comm comm, const char *file, PetscInt count_a, PetscInt count_b,
                            const EqmLandmarkList *list, const PetscReal *values)
{
  PetscInt *sorted;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < list->num; i++) {
    const PetscReal *const row = values + MOST_COLUMNS * i;
    if (!IsVertex(row[0], count_a))
      EqmFail(comm, EQM_ERR_USAGE, "%s: landmark %" PetscInt_FMT " names vertex %g of A, which has 0 to %" PetscInt_FMT,
              file, i + 1, (double)row[0], count_a - 1);
    if (list->width == 1 && count_b >= 0 && !IsVertex(row[1], count_b))
      EqmFail(comm, EQM_ERR_USAGE, "%s: landmark %" PetscInt_FMT " names vertex %g of B, which has 0 to %" PetscInt_FMT,
              file, i + 1, (double)row[1], count_b - 1);
  }
  PetscCall(PetscMalloc1(list->num, &sorted));
  PetscCall(PetscArraycpy(sorted, list->vertex, list->num));
  PetscCall(PetscSortInt(list->num, sorted));
  for (PetscInt i = 1; i < list->num; i++) {
    if (sorted[i] != sorted[i - 1]) continue;
    EqmFail(comm, EQM_ERR_USAGE, "%s: vertex %" PetscInt_FMT " of A is a landmark twice", file, sorted[i]);
  }
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLandmarkListRead(MPI_Comm comm, const char *file, PetscInt num_vertices_a, PetscInt num_vertices_b,
                                   EqmLandmarkList *list)
{
  Table table = {.num = 0};
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) error = ReadOnRoot(file, &table, message, sizeof(message));
  PetscCall(EqmAgree(comm, error, message));
  PetscCallMPI(MPI_Bcast(&table.num, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&table.columns, 1, MPIU_INT, 0, comm));
  if (rank != 0) PetscCall(PetscMalloc1(MOST_COLUMNS * table.num, &table.values));
  PetscCallMPI(MPI_Bcast(table.values, (PetscMPIInt)(MOST_COLUMNS * table.num), MPIU_REAL, 0, comm));
  list->num = table.num;
  list->width = table.columns - 1;
  PetscCall(PetscMalloc1(list->num, &list->vertex));
  PetscCall(PetscMalloc1(list->width * list->num, &list->other));
  for (PetscInt i = 0; i < list->num; i++) {
    const PetscReal vertex = table.values[MOST_COLUMNS * i];
    list->vertex[i] = IsVertex(vertex, num_vertices_a) ? (PetscInt)vertex : -1;
    for (PetscInt k = 0; k < list->width; k++)
      list->other[list->width * i + k] = table.values[MOST_COLUMNS * i + 1 + k];
  }
  PetscCall(Check(comm, file, num_vertices_a, num_vertices_b, list, table.values));
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmLandmarkListReset(EqmLandmarkList *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(list->vertex));
  PetscCall(PetscFree(list->other));
  list->num = 0;
  PetscFunctionReturn(0);
}
