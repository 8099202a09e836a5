/* EqmSoupReadDensity: one positive number per cell. */
#include "format.h"
#include "base/narrow.h"
#include "mesh/soup_private.h"
#include "hdf5.h"
#include "input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A CSV file whose last column is taken; its first line is a header. */
typedef struct {
  EqmInput in;
  PetscInt count, capacity;
  PetscReal *values;
} Column;

static PetscErrorCode Append(Column *column, PetscReal value)
{
  if (column->count == column->capacity) {
    column->capacity = PetscMax(1024, 2 * column->capacity);
    EqmTry(PetscRealloc((size_t)column->capacity * sizeof(PetscReal), &column->values));
  }
  column->values[column->count++] = value;
  return 0;
}

/* The last of the fields of [line, end), without blanks and quotes around it. */
static void LastField(const char **line, const char **end)
{
  const char *c = *end;

  while (c > *line && c[-1] != ',' && c[-1] != ';' && c[-1] != '\t') --c;
  *line = c;
  while (*line < *end && (EqmIsBlank(**line) || **line == '"')) ++*line;
  while (*end > *line && (EqmIsBlank((*end)[-1]) || (*end)[-1] == '"')) --*end;
}

static PetscErrorCode ParseLine(Column *column)
{
  EqmInput *in = &column->in;
  const char *line = in->cursor, *end = line;
  PetscReal value;

  while (end < in->end && *end != '\n' && *end != '\r') ++end;
  LastField(&line, &end);
  if (EqmParseReal(line, end, &value) != end || line == end) {
    return EqmRejectAt(in, line, EQM_ERR_IO, "the last column is not a number");
  }
  if (!(value > 0) || value > PETSC_MAX_REAL) {
    return EqmRejectAt(in, line, EQM_ERR_MESH, "the density %.6g is not positive and finite", (double)value);
  }
  return Append(column, value);
}

/* The header is a line that does not end in a number; a file without one would lose its first value silently. */
static PetscErrorCode SkipHeader(EqmInput *in)
{
  const char *line, *end;
  PetscReal value;

  EqmSkipMark(in);
  line = end = in->cursor;
  while (end < in->end && *end != '\n' && *end != '\r') ++end;
  LastField(&line, &end);
  if (line < end && EqmParseReal(line, end, &value) == end) {
    return EqmReject(in, EQM_ERR_IO, "the first line is a number; it must be a header, such as \"density\"");
  }
  EqmSkipLine(in);
  return 0;
}

static PetscErrorCode ParseColumn(Column *column, PetscInt num_cells)
{
  EqmInput *in = &column->in;

  EqmTry(SkipHeader(in));
  while (in->cursor < in->end) {
    if (!EqmAtLineEnd(in)) EqmTry(ParseLine(column));
    EqmSkipLine(in);
    if (column->count > num_cells) break;
  }
  if (column->count == num_cells) return 0;
  return EqmReject(in, EQM_ERR_MESH, "%s%lld values were found, but the mesh has %lld cells: one per cell is needed",
                   column->count > num_cells ? "more than " : "",
                   (long long)(column->count > num_cells ? num_cells : column->count), (long long)num_cells);
}

/* On rank 0. `hdf5` says that the file is one that all ranks read. */
static PetscErrorCode ReadOnRoot(const char *file, PetscInt num_cells, PetscBool *hdf5, PetscReal **values, char *error,
                                 size_t error_length)
{
  Column column = {.values = NULL};
  char *bytes, reason[EQM_MESSAGE_MAX / 2] = "";
  size_t length;
  PetscErrorCode code = EqmFormatLoadBytes(file, &bytes, &length, error, error_length);

  *hdf5 = PETSC_FALSE;
  if (!code) *hdf5 = EqmRecogniseHdf5(bytes, length);
  if (!code && !*hdf5) {
    EqmInputOpen(&column.in, bytes, length, reason, sizeof(reason));
    code = ParseColumn(&column, num_cells);
    if (code) snprintf(error, error_length, "%s: %s", file, reason);
  }
  free(bytes);
  *values = column.values;
  return code;
}

/* Deal the values of rank 0 to the slabs of cells. */
static PetscErrorCode Deal(EqmSoup soup, const PetscReal *values, PetscReal *density)
{
  PetscMPIInt rank, size, *counts, *starts;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(PetscMalloc2(size, &counts, size + 1, &starts));
  PetscCall(EqmGatherCounts(soup->comm, soup->cell_end - soup->cell_start, "values of a density", counts, starts));
  PetscCallMPI(MPI_Scatterv(values, counts, starts, MPIU_REAL, density, counts[rank], MPIU_REAL, 0, soup->comm));
  PetscCall(PetscFree2(counts, starts));
  PetscFunctionReturn(0);
}

/* Every value finite and positive, or all ranks fail. */
static PetscErrorCode CheckPositive(EqmSoup soup, const char *file, const PetscReal *density)
{
  char error[EQM_MESSAGE_MAX] = "";
  PetscErrorCode code = 0;

  PetscFunctionBegin;
  for (PetscInt i = soup->cell_start; i < soup->cell_end && !code; ++i) {
    const PetscReal value = density[i - soup->cell_start];

    if (value > 0 && value <= PETSC_MAX_REAL) continue;
    code = EQM_ERR_MESH;
    snprintf(error, sizeof(error), "%.1000s: the density of cell %lld is %g; it must be positive and finite", file,
             (long long)i, (double)value);
  }
  PetscCall(EqmAgree(soup->comm, code, error));
  PetscFunctionReturn(0);
}

/* Masses that far apart leave nothing of the smaller in any sum. */
static PetscErrorCode CheckSpan(EqmSoup soup, const char *file, const PetscReal *density)
{
  const PetscReal most = 1e100;
  PetscReal ends[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < soup->cell_end - soup->cell_start; i++) {
    ends[0] = PetscMin(ends[0], density[i]);
    ends[1] = PetscMin(ends[1], 1. / PetscMax(density[i], PETSC_MIN_REAL)); /* the largest, by its inverse */
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, ends, 2, MPIU_REAL, MPIU_MIN, soup->comm));
  if (ends[0] * ends[1] >= 1. / most || soup->num_cells == 0) PetscFunctionReturn(0);
  EqmFail(soup->comm, EQM_ERR_MESH,
          "%s: the densities run from %.6g to %.6g; more than a factor of %.6g between them no arithmetic of doubles "
          "resolves",
          file, (double)ends[0], (double)(1. / ends[1]), (double)most);
}

static PetscErrorCode FillDensity(EqmSoup soup, const char *file, PetscReal *density)
{
  PetscReal *values = NULL;
  char error[EQM_MESSAGE_MAX] = "";
  PetscBool hdf5 = PETSC_FALSE;
  PetscErrorCode code = 0;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  if (rank == 0) code = ReadOnRoot(file, soup->num_cells, &hdf5, &values, error, sizeof(error));
  code = EqmAgree(soup->comm, code, error);
  if (!code) {
    PetscCallMPI(MPI_Bcast(&hdf5, 1, MPIU_BOOL, 0, soup->comm));
    if (hdf5) {
      code = EqmSoupReadDensityHdf5(soup, file, density);
    } else {
      PetscCall(Deal(soup, values, density));
    }
  }
  PetscCall(PetscFree(values));
  PetscCall(code);
  PetscCall(CheckPositive(soup, file, density));
  PetscCall(CheckSpan(soup, file, density));
  PetscFunctionReturn(0);
}

/* EqmSoupReadDensity - read one positive number per cell into soup->density, in input order.

   Collective. From a CSV file with a header line (the last column is taken) or from /cell/density of an HDF5 file.
   Errors: EQM_ERR_IO (missing, unreadable, not a number), EQM_ERR_MESH (not one number per cell, not positive or not
   finite); soup->density is unchanged then. */
PetscErrorCode EqmSoupReadDensity(EqmSoup soup, const char *file)
{
  PetscReal *density;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(soup->cell_end - soup->cell_start + 1, &density));
  code = FillDensity(soup, file, density);
  if (code) {
    PetscCall(PetscFree(density));
    PetscFunctionReturn(code);
  }
  PetscCall(PetscFree(soup->density));
  soup->density = density;
  PetscFunctionReturn(0);
}
