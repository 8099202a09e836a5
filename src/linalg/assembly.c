/* Matrices from cell matrices: the pattern once, the values as often as needed, all through PETSc's coordinate format.
 */
#include "linalg/linalg.h"

struct _p_EqmAssembly {
  EqmMesh mesh;
  EqmUnknowns unknowns;
  EqmStorage storage;
  Mat matrix;
  PetscInt *cell_start; /* per local cell: place of its first entry among `values` */
  PetscReal *values;
};

/* Does this rank keep the entry (row, column)? Rows of other ranks are theirs: their ghost layer has the same cell. */
static inline PetscBool Keeps(const EqmUnknowns *unknowns, EqmStorage storage, PetscInt row, PetscInt column)
{
  if (row < unknowns->first || row >= unknowns->first + unknowns->num_owned) return PETSC_FALSE;
  return (PetscBool)(storage == EQM_STORE_FULL || column <= row);
}

/* Global unknowns of a cell in the order of its matrix; returns how many. */
static inline PetscInt CellUnknowns(EqmMesh mesh, const EqmUnknowns *unknowns, PetscInt cell,
                                    PetscInt list[EQM_MOST_CELL_UNKNOWNS])
{
  PetscInt count = 0;

  for (PetscInt a = 0; a < mesh->cell_size; a++) {
    const PetscInt v = mesh->cells[mesh->cell_size * cell + a];
    for (PetscInt k = 0; k < unknowns->count[v]; k++) list[count++] = unknowns->start[v] + k;
  }
  return count;
}

/* Places of the cells' entries among the values. */
static PetscErrorCode CountEntries(EqmAssembly assembly)
{
  const EqmMesh mesh = assembly->mesh;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells + 1, &assembly->cell_start));
  assembly->cell_start[0] = 0;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt list[EQM_MOST_CELL_UNKNOWNS], kept = 0;
    const PetscInt n = CellUnknowns(mesh, &assembly->unknowns, c, list);
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt j = 0; j < n; j++) kept += Keeps(&assembly->unknowns, assembly->storage, list[i], list[j]);
    }
    assembly->cell_start[c + 1] = assembly->cell_start[c] + kept;
  }
  PetscFunctionReturn(0);
}

/* Make the pattern of a matrix with the given unknowns. Collective. */
PetscErrorCode EqmAssemblyCreate(EqmMesh mesh, const EqmUnknowns *unknowns, EqmStorage storage, EqmAssembly *out)
{
  EqmAssembly assembly;
  PetscInt *row, *column, num_entries;

  PetscFunctionBegin;
  PetscCall(PetscNew(&assembly));
  assembly->mesh = mesh;
  assembly->unknowns = *unknowns;
  assembly->storage = storage;
  PetscCall(CountEntries(assembly));
  num_entries = assembly->cell_start[mesh->num_local_cells];
  PetscCall(PetscMalloc2(num_entries, &row, num_entries, &column));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt list[EQM_MOST_CELL_UNKNOWNS], entry = assembly->cell_start[c];
    const PetscInt n = CellUnknowns(mesh, unknowns, c, list);
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt j = 0; j < n; j++) {
        if (!Keeps(unknowns, storage, list[i], list[j])) continue;
        row[entry] = list[i];
        column[entry++] = list[j];
      }
    }
  }
  PetscCall(MatCreate(mesh->comm, &assembly->matrix));
  PetscCall(MatSetSizes(assembly->matrix, unknowns->num_owned, unknowns->num_owned, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(assembly->matrix, MATAIJ));
  PetscCall(MatSetPreallocationCOO(assembly->matrix, num_entries, row, column));
  PetscCall(PetscFree2(row, column));
  PetscCall(PetscCalloc1(num_entries, &assembly->values));
  PetscCall(MatSetValuesCOO(assembly->matrix, assembly->values, INSERT_VALUES)); /* the rows can be read from now on */
  *out = assembly;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmAssemblyDestroy(EqmAssembly *assembly)
{
  PetscFunctionBegin;
  if (!*assembly) PetscFunctionReturn(0);
  PetscCall(MatDestroy(&(*assembly)->matrix));
  PetscCall(PetscFree((*assembly)->cell_start));
  PetscCall(PetscFree((*assembly)->values));
  PetscCall(PetscFree(*assembly));
  PetscFunctionReturn(0);
}

/* New values: the sum of the cells' matrices, in a fixed order. Collective. */
PetscErrorCode EqmAssemblyFill(EqmAssembly assembly, EqmCellMatrix cell_matrix, void *context)
{
  const EqmMesh mesh = assembly->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_ASSEMBLE));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscReal matrix[EQM_MOST_CELL_UNKNOWNS * EQM_MOST_CELL_UNKNOWNS];
    PetscInt list[EQM_MOST_CELL_UNKNOWNS], entry = assembly->cell_start[c];
    const PetscInt n = CellUnknowns(mesh, &assembly->unknowns, c, list);
    cell_matrix(context, c, matrix);
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt j = 0; j < n; j++) {
        if (Keeps(&assembly->unknowns, assembly->storage, list[i], list[j]))
          assembly->values[entry++] = matrix[n * i + j];
      }
    }
  }
  PetscCall(MatSetValuesCOO(assembly->matrix, assembly->values, INSERT_VALUES));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_ASSEMBLE));
  PetscFunctionReturn(0);
}

/* The matrix; the assembly keeps it. Not collective. */
PetscErrorCode EqmAssemblyGetMat(EqmAssembly assembly, Mat *matrix)
{
  PetscFunctionBegin;
  *matrix = assembly->matrix;
  PetscFunctionReturn(0);
}
