/* Landmarks from a CSV file. */
#include "format/landmark_list.h"
#include "format/table.h"
#include <stdio.h>

static const char wanted[] = "a landmark is a vertex of A and a vertex of B (two numbers), or a vertex of A and a "
                             "point (three or four numbers), "
                             "and behind these what columns called weight and curve hold";

/* A whole number between 0 and count - 1 is wanted. */
static PetscErrorCode CheckVertex(MPI_Comm comm, const char *file, PetscInt landmark, PetscReal value, const char *name,
                                  PetscInt count)
{
  char text[32];

  PetscFunctionBegin;
  if (value >= 0. && value < count && value == PetscFloorReal(value)) PetscFunctionReturn(0);
  (void)snprintf(text, sizeof(text), "%g", (double)value);
  EqmFail(comm, EQM_ERR_USAGE, "%s: landmark %" PetscInt_FMT " names vertex %s of %s, which has 0 to %" PetscInt_FMT,
          file, landmark + 1, text, name, count - 1);
}

/* A vertex has one counterpart. */
static PetscErrorCode CheckTwice(MPI_Comm comm, const char *file, const EqmTable *table, PetscInt column,
                                 const char *name)
{
  PetscInt *sorted;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(table->rows, &sorted));
  for (PetscInt i = 0; i < table->rows; i++) sorted[i] = (PetscInt)table->values[table->columns * i + column];
  PetscCall(PetscSortInt(table->rows, sorted));
  for (PetscInt i = 1; i < table->rows; i++) {
    if (sorted[i] != sorted[i - 1]) continue;
    EqmFail(comm, EQM_ERR_USAGE, "%s: vertex %" PetscInt_FMT " of %s is a landmark twice", file, sorted[i], name);
  }
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(0);
}

/* Where the columns are that have a meaning by their name; -1: there is none. */
typedef struct {
  PetscInt weight, curve;
} Columns;

/* They stand behind the numbers that every landmark has. */
static PetscErrorCode FindColumns(MPI_Comm comm, const char *file, const EqmTable *table, Columns *columns,
                                  PetscInt *width)
{
  PetscInt named = 0;

  PetscFunctionBegin;
  *columns = (Columns){-1, -1};
  for (PetscInt k = 2; k < table->columns; k++) {
    PetscBool weight, curve;
    PetscCall(PetscStrcasecmp(table->name[k], "weight", &weight));
    PetscCall(PetscStrcasecmp(table->name[k], "curve", &curve));
    if (weight) columns->weight = k;
    if (curve) columns->curve = k;
    named += weight || curve;
    if (named > 0 && !weight && !curve)
      EqmFail(comm, EQM_ERR_USAGE, "%s: the columns weight and curve come last, behind the landmark's vertex and point",
              file);
  }
  *width = table->columns - named - 1;
  if (*width > 3) EqmFail(comm, EQM_ERR_USAGE, "%s: %s", file, wanted);
  PetscFunctionReturn(0);
}

/* The weight and the curve of a landmark. */
static PetscErrorCode TakeNamed(MPI_Comm comm, const char *file, const Columns *columns, const PetscReal *row,
                                PetscInt i, EqmLandmarkList *list)
{
  const PetscReal weight = columns->weight < 0 ? 1. : row[columns->weight];
  const PetscReal curve = columns->curve < 0 ? -1. : row[columns->curve];

  PetscFunctionBegin;
  if (!(weight > 0.) || PetscIsInfReal(weight))
    EqmFail(comm, EQM_ERR_USAGE, "%s: landmark %" PetscInt_FMT " has weight %g; give a number above 0", file, i + 1,
            (double)weight);
  if (curve != PetscFloorReal(curve) || !(PetscAbsReal(curve) < 1e9))
    EqmFail(comm, EQM_ERR_USAGE,
            "%s: landmark %" PetscInt_FMT " names curve %g; give a whole number, or -1 for a landmark of no curve",
            file, i + 1, (double)curve);
  list->weight[i] = weight;
  list->curve[i] = (PetscInt)curve;
  list->has_curves = (PetscBool)(list->has_curves || curve >= 0.);
  PetscFunctionReturn(0);
}

/* Fill the list from the rows that every rank has. */
static PetscErrorCode Take(MPI_Comm comm, const char *file, PetscInt count_a, PetscInt count_b, const EqmTable *table,
                           EqmLandmarkList *list)
{
  Columns columns;

  PetscFunctionBegin;
  PetscCall(FindColumns(comm, file, table, &columns, &list->width));
  list->num = table->rows;
  list->has_weights = (PetscBool)(columns.weight >= 0);
  PetscCall(PetscMalloc4(list->num, &list->vertex, list->width * list->num, &list->other, list->num, &list->weight,
                         list->num, &list->curve));
  for (PetscInt i = 0; i < list->num; i++) {
    const PetscReal *const row = table->values + table->columns * i;
    PetscCall(CheckVertex(comm, file, i, row[0], "A", count_a));
    if (list->width == 1 && count_b >= 0) PetscCall(CheckVertex(comm, file, i, row[1], "B", count_b));
    list->vertex[i] = (PetscInt)row[0];
    for (PetscInt k = 0; k < list->width; k++) {
      if (PetscIsInfOrNanReal(row[1 + k]))
        EqmFail(comm, EQM_ERR_USAGE, "%s: landmark %" PetscInt_FMT " has a coordinate that is no finite number", file,
                i + 1);
      list->other[list->width * i + k] = row[1 + k];
    }
    PetscCall(TakeNamed(comm, file, &columns, row, i, list));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLandmarkListRead(MPI_Comm comm, const char *file, PetscInt num_vertices_a, PetscInt num_vertices_b,
                                   EqmLandmarkList *list)
{
  EqmTable table;
  PetscMPIInt rank, count;

  PetscFunctionBegin;
  PetscCall(EqmTableRead(comm, file, 2, 6, wanted, &table));
  PetscCall(PetscMPIIntCast(table.columns * table.rows, &count));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank != 0) PetscCall(PetscMalloc1(table.columns * table.rows, &table.values));
  PetscCallMPI(MPI_Bcast(table.values, count, MPIU_REAL, 0, comm));
  PetscCall(Take(comm, file, num_vertices_a, num_vertices_b, &table, list));
  PetscCall(CheckTwice(comm, file, &table, 0, "A"));
  if (list->width == 1) PetscCall(CheckTwice(comm, file, &table, 1, "B"));
  PetscCall(PetscFree(table.values));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmLandmarkListReset(EqmLandmarkList *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(list->vertex, list->other, list->weight, list->curve));
  list->num = 0;
  PetscFunctionReturn(0);
}
