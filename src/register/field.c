/* Read fields: from the mesh itself, its HDF5 file, or a CSV file. */
#include "register/field.h"
#include "mesh/soup_private.h"
#include "format/table.h"
#include "h5/h5.h"
#include "base/rows.h"
#include "store/store.h"
#include <math.h>
#include <string.h>

/* Letters and digits of the source's name, underscores for the rest; of a file its name alone. */
static void NameField(const char *source, EqmCarriedField *field)
{
  const char *const slash = strrchr(source, '/');
  const PetscBool is_file = EqmHasSuffix(source, ".csv");
  const char *begin = is_file && slash ? slash + 1 : source + strspn(source, "/");
  size_t n = strlen(begin);

  if (is_file) n -= strlen(".csv");
  (void)snprintf(field->name, sizeof(field->name), "%.*s", (int)n, begin);
  for (char *c = field->name; *c; c++) {
    if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-", *c)) *c = '_';
  }
}

/* Is the field on vertices or cells? By the number of rows; if vertices and cells are equally many, by the dataset's
   path. */
static PetscErrorCode Recognise(EqmSoup soup, const char *source, PetscInt64 rows, EqmCarriedField *field)
{
  PetscFunctionBegin;
  field->on_cells = (PetscBool)(rows == soup->num_cells && (rows != soup->num_vertices || strstr(source, "cell")));
  if (rows != soup->num_vertices && rows != soup->num_cells)
    EqmFail(soup->comm, EQM_ERR_USAGE,
            "-transfer %s: %" PetscInt64_FMT " rows, but %s has %" PetscInt_FMT " vertices and %" PetscInt_FMT " cells",
            source, rows, soup->file, soup->num_vertices, soup->num_cells);
  PetscFunctionReturn(0);
}

/* First row and number of rows of this rank. */
static void SlabOf(EqmSoup soup, const EqmCarriedField *field, PetscInt *start, PetscInt *count)
{
  *start = field->on_cells ? soup->cell_start : soup->vertex_start;
  *count = (field->on_cells ? soup->cell_end : soup->vertex_end) - *start;
}

static PetscErrorCode TakeDataset(EqmH5 h5, EqmSoup soup, const char *path, EqmCarriedField *field)
{
  PetscInt64 rows, width;
  EqmSlab slab = {0};
  PetscBool has;

  PetscFunctionBegin;
  PetscCall(EqmH5HasDataset(h5, path, &has));
  if (!has) EqmFail(soup->comm, EQM_ERR_USAGE, "-transfer %s: %s has no such dataset", path, h5->name);
  PetscCall(EqmH5GetShape(h5, path, &rows, &width));
  PetscCall(Recognise(soup, path, rows, field));
  slab.total = (PetscInt)rows;
  slab.width = (PetscInt)width;
  SlabOf(soup, field, &slab.start, &slab.count);
  field->width = PetscMax(1, slab.width);
  PetscCall(PetscMalloc1(field->width * slab.count + 1, &field->slab));
  PetscCall(EqmH5ReadReals(h5, path, slab, field->slab));
  PetscFunctionReturn(0);
}

static PetscErrorCode ReadDataset(EqmSoup soup, const char *path, EqmCarriedField *field)
{
  PetscErrorCode error;
  EqmH5 h5;

  PetscFunctionBegin;
  PetscCall(EqmH5Open(soup->comm, soup->file, &h5));
  error = TakeDataset(h5, soup, path, field);
  PetscCall(EqmH5Close(&h5));
  PetscCall(error);
  PetscFunctionReturn(0);
}

/* Rank 0 has the rows and distributes them. */
static PetscErrorCode ReadCsv(EqmSoup soup, const char *file, EqmCarriedField *field)
{
  PetscInt start, count, *rows;
  EqmTable table;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCall(EqmTableRead(soup->comm, file, 1, EQM_MOST_COLUMNS, "numbers are wanted, as many in every row", &table));
  PetscCall(Recognise(soup, file, table.rows, field));
  field->width = table.columns;
  SlabOf(soup, field, &start, &count);
  PetscCall(PetscMalloc1(field->width * count + 1, &field->slab));
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMalloc1(count, &rows));
  for (PetscInt k = 0; k < count; k++) rows[k] = start + k;
  PetscCall(EqmFetchRows(soup->comm, rank == 0 ? table.rows : 0, count, rows, MPIU_REAL, field->width, table.values,
                         field->slab));
  PetscCall(PetscFree(rows));
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFieldRead(EqmSoup soup, const char *source, EqmCarriedField *field)
{
  PetscFunctionBegin;
  NameField(source, field);
  if (!strcmp(source, "coordinates")) {
    const PetscInt length = 3 * (soup->vertex_end - soup->vertex_start);
    field->on_cells = PETSC_FALSE;
    field->width = 3;
    PetscCall(PetscMalloc1(length + 1, &field->slab));
    PetscCall(PetscArraycpy(field->slab, soup->vertices, length));
  } else if (EqmHasSuffix(source, ".csv")) {
    PetscCall(ReadCsv(soup, source, field));
  } else if (source[0] == '/' && EqmHasSuffix(soup->file, ".h5")) {
    PetscCall(ReadDataset(soup, source, field));
  } else {
    EqmFail(soup->comm, EQM_ERR_USAGE,
            "-transfer %s: give coordinates, a dataset of the mesh's .h5 file (/vertex/ratio), or a .csv file with a "
            "header and a row per vertex or cell",
            source);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFieldShift(EqmSoup soup, PetscInt exponent, EqmCarriedField *field)
{
  PetscInt start, count;

  PetscFunctionBegin;
  SlabOf(soup, field, &start, &count);
  for (PetscInt k = 0; k < field->width * count; k++) field->slab[k] = ldexp(field->slab[k], (int)exponent);
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmFieldReset(EqmCarriedField *field)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(field->slab));
  PetscFunctionReturn(0);
}
