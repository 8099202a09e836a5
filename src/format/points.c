#include "points.h"
#include "input.h"
#include "scalar.h"

#include <string.h>
#include <strings.h>

static const char npy_magic[] = "\223NUMPY";

static PetscBool IsNpy(const char *bytes, size_t length)
{
  return length >= 10 && !memcmp(bytes, npy_magic, 6) ? PETSC_TRUE : PETSC_FALSE;
}

/* EqmPointsRecognise - an NPY file by its first bytes, a CSV file by its name. Not collective. */
PetscBool EqmPointsRecognise(const char *file, const char *bytes, size_t length)
{
  const char *const dot = strrchr(file, '.');

  return IsNpy(bytes, length) || (dot && (!strcasecmp(dot, ".csv") || !strcasecmp(dot, ".npy"))) ? PETSC_TRUE
                                                                                                 : PETSC_FALSE;
}

/* What stands behind 'KEY': in the header of an NPY file, a Python dictionary; NULL: it is not there. */
static const char *FindKey(const char *header, const char *key)
{
  const char *const found = strstr(header, key), *const colon = found ? strchr(found + strlen(key), ':') : NULL;

  return colon ? colon + 1 + strspn(colon + 1, " ") : NULL;
}

static PetscErrorCode ParseNpyType(EqmInput *in, const char *text, EqmScalarType *type, PetscBool *big_endian)
{
  const char quote = text ? *text : 0;

  if (quote != '\'' && quote != '"') return EqmReject(in, EQM_ERR_IO, "the header of the NPY file is damaged");
  *big_endian = text[1] == '>' ? PETSC_TRUE : PETSC_FALSE;
  *type = !strncmp(text + 2, "f8", 2) ? EQM_SCALAR_FLOAT64 : !strncmp(text + 2, "f4", 2) ? EQM_SCALAR_FLOAT32 : 0;
  if (*type) return 0;
  return EqmReject(in, EQM_ERR_IO, "numbers of type %.4s: save the array as float64 or float32", text + 1);
}

/* (rows, columns), or (columns, rows) and transposed by the caller: the shape must be n x 2 or n x 3. */
static PetscErrorCode ParseNpyShape(EqmInput *in, const char *text, EqmPoints *points)
{
  const char *const end = text ? text + strlen(text) : NULL;
  PetscInt64 rows = -1, columns = -1;
  const char *c = text && *text == '(' ? EqmParseInteger(text + 1, end, &rows) : NULL;

  if (c && *c == ',') c = EqmParseInteger(c + 1 + strspn(c + 1, " "), end, &columns);
  if (!c || rows < 0 || rows > PETSC_MAX_INT || (columns != 2 && columns != 3))
    return EqmReject(in, EQM_ERR_IO, "the array must have one row per vertex and two or three columns");
  points->num = (PetscInt)rows;
  points->dim = (PetscInt)columns;
  return 0;
}

/* The format of numpy.lib.format: magic, version, length of the header, header, numbers. */
static PetscErrorCode ParseNpy(EqmInput *in, EqmPoints *points)
{
  const PetscBool short_header = in->cursor[6] == 1 ? PETSC_TRUE : PETSC_FALSE;
  const char *bytes, *order;
  char header[1024] = "";
  PetscInt64 header_bytes;
  EqmScalarType type;
  PetscBool big_endian;
  size_t size, count;

  in->binary = PETSC_TRUE;
  EqmTry(EqmTakeBytes(in, 8, "header", &bytes));
  EqmTry(EqmTakeBytes(in, short_header ? 2 : 4, "header", &bytes));
  header_bytes = EqmLoadInteger(bytes, short_header ? EQM_SCALAR_UINT16 : EQM_SCALAR_UINT32, PETSC_FALSE);
  EqmTry(EqmTakeBytes(in, (size_t)header_bytes, "header", &bytes));
  memcpy(header, bytes, PetscMin((size_t)header_bytes, sizeof(header) - 1));
  EqmTry(ParseNpyType(in, FindKey(header, "descr"), &type, &big_endian));
  EqmTry(ParseNpyShape(in, FindKey(header, "shape"), points));
  order = FindKey(header, "fortran_order");
  size = EqmScalarSize(type);
  count = (size_t)points->num * (size_t)points->dim;
  EqmTry(EqmTakeBytes(in, count * size, "numbers", &bytes));
  EqmTry(PetscMalloc1(count + 1, &points->values));
  for (size_t i = 0; i < count; ++i) {
    const size_t row = i / (size_t)points->dim, column = i % (size_t)points->dim;
    const size_t at = order && *order == 'T' ? column * (size_t)points->num + row : i;

    points->values[i] = EqmLoadReal(bytes + at * size, type, big_endian);
  }
  return 0;
}

/* The numbers of this line, separated by commas, semicolons or blanks; -1 if there is something else. */
static PetscInt ReadRow(EqmInput *in, PetscReal values[4])
{
  PetscInt count = 0;

  while (!EqmAtLineEnd(in)) {
    const char *const next = count < 4 ? EqmParseReal(in->cursor, in->end, &values[count++]) : NULL;

    if (!next || (next < in->end && !EqmIsSpace(*next) && *next != ',' && *next != ';')) return -1;
    in->cursor = next;
    EqmSkipBlanks(in);
    if (in->cursor < in->end && (*in->cursor == ',' || *in->cursor == ';')) ++in->cursor;
  }
  return count;
}

/* Does the header's first name say that a vertex number stands in the first column? */
static PetscBool HasNumbers(EqmInput in)
{
  const char *word;
  size_t length;

  while (in.cursor < in.end && (EqmIsBlank(*in.cursor) || *in.cursor == '"')) ++in.cursor;
  word = in.cursor;
  for (length = 0;
       word + length < in.end && strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_", word[length]);)
    ++length;
  return EqmWordIs(word, length, "vertex") || EqmWordIs(word, length, "index") || EqmWordIs(word, length, "id")
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Rows of numbers as they stand in the file; `width` each. */
static PetscErrorCode ParseRows(EqmInput *in, PetscInt *width, PetscInt *num, PetscReal **rows)
{
  PetscInt capacity = 0;
  PetscReal values[4];

  for (; in->cursor < in->end; EqmSkipLine(in)) {
    PetscInt count;

    if (EqmAtLineEnd(in)) continue;
    count = ReadRow(in, values);
    if (!*width) *width = count;
    if (count != *width || count < 2)
      return EqmReject(in, EQM_ERR_IO, "two or three coordinates are needed on each line, as many as on the first");
    if (*num == capacity) {
      capacity = PetscMax(1024, 2 * capacity);
      EqmTry(PetscRealloc((size_t)(*width) * (size_t)capacity * sizeof(PetscReal), rows));
    }
    for (PetscInt k = 0; k < count; ++k) (*rows)[(size_t)count * (size_t)*num + (size_t)k] = values[k];
    ++*num;
  }
  return *num ? 0 : EqmReject(in, EQM_ERR_IO, "there are no coordinates in it");
}

/* Rows that begin with a vertex number go to their vertex; every vertex must have one. */
static PetscErrorCode SortRows(EqmInput *in, PetscInt width, PetscInt num, const PetscReal *rows, EqmPoints *points)
{
  PetscBool *has;
  PetscErrorCode code = 0;

  EqmTry(PetscCalloc1(num, &has));
  for (PetscInt i = 0; i < num && !code; ++i) {
    const PetscReal *const row = rows + (size_t)width * (size_t)i;
    const PetscInt vertex = row[0] >= 0 && row[0] < num ? (PetscInt)row[0] : -1;

    if (vertex < 0 || (PetscReal)vertex != row[0] || has[vertex]) {
      code = EqmRejectAt(in, NULL, EQM_ERR_IO,
                         "row %lld: vertex number %g is not one of 0..%lld, each of which must come once", (long long)i,
                         (double)row[0], (long long)num - 1);
      break;
    }
    has[vertex] = PETSC_TRUE;
    for (PetscInt k = 1; k < width; ++k) points->values[(size_t)(width - 1) * (size_t)vertex + (size_t)k - 1] = row[k];
  }
  EqmTry(PetscFree(has));
  return code;
}

/* With or without a header. A first column `vertex`, or four columns, give vertex numbers. */
static PetscErrorCode ParseCsv(EqmInput *in, EqmPoints *points)
{
  PetscReal values[4], *rows = NULL;
  PetscInt width = 0, num = 0;
  PetscBool numbered;
  PetscErrorCode code;
  EqmInput first;

  EqmSkipMark(in);
  first = *in;
  numbered = HasNumbers(*in);
  if (ReadRow(&first, values) < 2) EqmSkipLine(in); /* the header */
  code = ParseRows(in, &width, &num, &rows);
  if (!code && width == 4) numbered = PETSC_TRUE;
  if (!code && numbered && width == 2)
    code = EqmReject(in, EQM_ERR_IO, "a vertex number and one coordinate: two or three coordinates are needed");
  points->num = num;
  points->dim = width - (numbered ? 1 : 0);
  if (!code && numbered) {
    code = PetscMalloc1((size_t)points->dim * (size_t)num, &points->values);
    if (!code) code = SortRows(in, width, num, rows, points);
    EqmTry(PetscFree(rows));
  } else {
    points->values = rows;
  }
  return code;
}

/* EqmPointsParse - read a CSV or an NPY file. Not collective. Errors (quiet, reason in `error`): EQM_ERR_IO; nothing to
   free then. */
PetscErrorCode EqmPointsParse(const char *bytes, size_t length, EqmPoints *points, char *error, size_t error_length)
{
  EqmInput in;
  PetscErrorCode code;

  *points = (EqmPoints){0};
  EqmInputOpen(&in, bytes, length, error, error_length);
  code = IsNpy(bytes, length) ? ParseNpy(&in, points) : ParseCsv(&in, points);
  if (code) EqmTry(PetscFree(points->values));
  return code;
}
