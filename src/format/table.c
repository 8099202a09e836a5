/* CSV files of numbers, read by rank 0. */
#include "format/table.h"
#include "format/format.h"
#include "format/input.h"
#include <stdio.h>
#include <stdlib.h>

/* A table that is being read. */
typedef struct {
  EqmInput in;
  EqmTable *table;
  PetscInt room, least, most; /* rows that fit; columns allowed */
  const char *wanted;
} Reading;

/* The numbers of a line; -1 where something else stands there, or too many. */
static PetscInt ReadNumbers(const EqmInput *in, PetscInt most, PetscReal *values)
{
  const char *c = in->cursor, *end = c;
  PetscInt count = 0;

  while (end < in->end && *end != '\n' && *end != '\r') ++end;
  while (end > c && EqmIsBlank(end[-1])) --end;
  while (c < end) {
    while (c < end && EqmIsBlank(*c)) ++c;
    if (count == most) return -1;
    c = EqmParseReal(c, end, &values[count++]);
    if (!c) return -1;
    while (c < end && (*c == ' ')) ++c;
    if (c < end && *c != ',' && *c != ';' && *c != '\t') return -1;
    if (c < end && ++c == end) return -1;
  }
  return count;
}

static PetscErrorCode ParseRow(Reading *reading)
{
  EqmTable *const table = reading->table;
  PetscReal values[EQM_MOST_COLUMNS] = {0.};
  const PetscInt count = ReadNumbers(&reading->in, reading->most, values);

  if (count < reading->least) return EqmReject(&reading->in, EQM_ERR_IO, "%s", reading->wanted);
  if (table->columns == 0) table->columns = count;
  if (count != table->columns)
    return EqmReject(&reading->in, EQM_ERR_IO, "%d numbers, where the lines before have %d", (int)count,
                     (int)table->columns);
  if (table->rows == reading->room) {
    reading->room = PetscMax(1024, 2 * reading->room);
    EqmTry(PetscRealloc(sizeof(PetscReal) * (size_t)(count * reading->room), &table->values));
  }
  for (PetscInt k = 0; k < count; k++) table->values[count * table->rows + k] = values[k];
  table->rows++;
  return 0;
}

/* The names in the header, without blanks and quotes around them. */
static void ReadNames(const EqmInput *in, EqmTable *table)
{
  const char *c = in->cursor;
  PetscInt column = 0;
  size_t length = 0;

  for (; c < in->end && *c != '\n' && *c != '\r' && column < EQM_MOST_COLUMNS; ++c) {
    if (*c == ',' || *c == ';' || *c == '\t') {
      ++column;
      length = 0;
    } else if (length + 1 < EQM_COLUMN_NAME && *c != ' ' && *c != '"') {
      table->name[column][length++] = *c;
    }
  }
}

static PetscErrorCode ParseTable(Reading *reading)
{
  EqmInput *const in = &reading->in;
  PetscReal values[EQM_MOST_COLUMNS];

  EqmSkipMark(in);
  if (ReadNumbers(in, EQM_MOST_COLUMNS, values) >= 1)
    return EqmReject(in, EQM_ERR_IO, "the first line is numbers; it must be a header with the names of the columns");
  ReadNames(in, reading->table);
  for (EqmSkipLine(in); in->cursor < in->end; EqmSkipLine(in)) {
    if (!EqmAtLineEnd(in)) EqmTry(ParseRow(reading));
  }
  return reading->table->rows ? 0 : EqmReject(in, EQM_ERR_IO, "there are no numbers in it");
}

static PetscErrorCode ReadOnRoot(const char *file, Reading *reading, char *error, size_t length)
{
  char *bytes, reason[EQM_MESSAGE_MAX / 2] = "";
  size_t size;
  PetscErrorCode code = EqmFormatLoadBytes(file, &bytes, &size, error, length);

  if (!code) {
    EqmInputOpen(&reading->in, bytes, size, reason, sizeof(reason));
    code = ParseTable(reading);
    if (code) (void)snprintf(error, length, "%s: %s", file, reason);
  }
  free(bytes);
  return code;
}

PetscErrorCode EqmTableRead(MPI_Comm comm, const char *file, PetscInt least, PetscInt most, const char *wanted,
                            EqmTable *table)
{
  Reading reading = {.table = table, .least = least, .most = most, .wanted = wanted};
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  *table = (EqmTable){.rows = 0};
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) error = ReadOnRoot(file, &reading, message, sizeof(message));
  PetscCall(EqmAgree(comm, error, message));
  PetscCallMPI(MPI_Bcast(&table->rows, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&table->columns, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(table->name, EQM_MOST_COLUMNS * EQM_COLUMN_NAME, MPI_CHAR, 0, comm));
  PetscFunctionReturn(0);
}
