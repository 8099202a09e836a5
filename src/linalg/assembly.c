/* Matrices from cell matrices: the pattern once, the values as often as needed, all through PETSc's coordinate format.
 */
#include "linalg/linalg.h"

struct _p_EqmAssembly {
  EqmMesh mesh;
  EqmUnknowns unknowns;
  EqmStorage storage;
  Mat matrix;
  PetscInt *cell_start; /* per local cell: place of its first entry among the slots */
  PetscInt
      *slot; /* per kept entry: place among the values of the diagonal block, or minus one minus that of the other */
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

/* The pattern through the coordinate format, whose book-keeping stays behind in the copy that is thrown away. */
static PetscErrorCode MakePattern(EqmAssembly assembly)
{
  const EqmMesh mesh = assembly->mesh;
  const EqmUnknowns *const unknowns = &assembly->unknowns;
  const PetscInt num_entries = assembly->cell_start[mesh->num_local_cells];
  PetscInt *row, *column;
  Mat pattern;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(num_entries, &row, num_entries, &column));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt list[EQM_MOST_CELL_UNKNOWNS], entry = assembly->cell_start[c];
    const PetscInt n = CellUnknowns(mesh, unknowns, c, list);
    for (PetscInt k = 0; k < n * n; k++) {
      if (!Keeps(unknowns, assembly->storage, list[k / n], list[k % n])) continue;
      row[entry] = list[k / n];
      column[entry++] = list[k % n];
    }
  }
  PetscCall(MatCreate(mesh->comm, &pattern));
  PetscCall(MatSetSizes(pattern, unknowns->num_owned, unknowns->num_owned, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(pattern, MATAIJ));
  PetscCall(MatSetPreallocationCOO(pattern, num_entries, row, column));
  PetscCall(PetscFree2(row, column));
  PetscCall(MatAssemblyBegin(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(pattern, MAT_FINAL_ASSEMBLY));
  PetscCall(MatDuplicate(pattern, MAT_DO_NOT_COPY_VALUES, &assembly->matrix));
  PetscCall(MatDestroy(&pattern));
  PetscFunctionReturn(0);
}

/* Look at the blocks of a matrix; give them back with EqmBlocksRestore. Collective. */
PetscErrorCode EqmBlocksGet(Mat matrix, EqmBlocks *blocks)
{
  PetscInt n;
  PetscMPIInt size;
  PetscBool done;

  PetscFunctionBegin;
  *blocks = (EqmBlocks){0};
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)matrix), &size));
  if (size == 1)
    blocks->block[0] = matrix;
  else
    PetscCall(MatMPIAIJGetSeqAIJ(matrix, &blocks->block[0], &blocks->block[1], &blocks->global_column));
  for (int b = 0; b < 2 && blocks->block[b]; b++) {
    PetscCall(
        MatGetRowIJ(blocks->block[b], 0, PETSC_FALSE, PETSC_FALSE, &n, &blocks->start[b], &blocks->column[b], &done));
    PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no access to the rows of a matrix");
    PetscCall(MatSeqAIJGetArray(blocks->block[b], &blocks->value[b]));
  }
  if (blocks->block[1]) PetscCall(MatGetSize(blocks->block[1], NULL, &blocks->num_global_columns));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmBlocksRestore(EqmBlocks *blocks)
{
  PetscInt n;
  PetscBool done;

  PetscFunctionBegin;
  for (int b = 0; b < 2 && blocks->block[b]; b++) {
    PetscCall(MatSeqAIJRestoreArray(blocks->block[b], &blocks->value[b]));
    PetscCall(MatRestoreRowIJ(blocks->block[b], 0, PETSC_FALSE, PETSC_FALSE, &n, &blocks->start[b], &blocks->column[b],
                              &done));
  }
  PetscFunctionReturn(0);
}

/* Where (row, column) is kept. */
static PetscErrorCode FindSlot(const EqmBlocks *blocks, PetscInt first, PetscInt num_owned, PetscInt row,
                               PetscInt column, PetscInt *slot)
{
  const int b = column >= first && column < first + num_owned ? 0 : 1;
  PetscInt local = column - first, place;

  PetscFunctionBegin;
  if (b == 1) PetscCall(PetscFindInt(column, blocks->num_global_columns, blocks->global_column, &local));
  const PetscInt begin = blocks->start[b][row - first], length = blocks->start[b][row - first + 1] - begin;
  PetscCall(PetscFindInt(local, length, blocks->column[b] + begin, &place));
  PetscCheck(place >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "entry (%" PetscInt_FMT ", %" PetscInt_FMT ") is missing in the pattern", row, column);
  *slot = b == 0 ? begin + place : -1 - (begin + place);
  PetscFunctionReturn(0);
}

static PetscErrorCode FindSlots(EqmAssembly assembly)
{
  const EqmMesh mesh = assembly->mesh;
  const EqmUnknowns *const unknowns = &assembly->unknowns;
  EqmBlocks blocks;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(assembly->cell_start[mesh->num_local_cells], &assembly->slot));
  PetscCall(EqmBlocksGet(assembly->matrix, &blocks));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt list[EQM_MOST_CELL_UNKNOWNS], entry = assembly->cell_start[c];
    const PetscInt n = CellUnknowns(mesh, unknowns, c, list);
    for (PetscInt k = 0; k < n * n; k++) {
      if (!Keeps(unknowns, assembly->storage, list[k / n], list[k % n])) continue;
      PetscCall(
          FindSlot(&blocks, unknowns->first, unknowns->num_owned, list[k / n], list[k % n], &assembly->slot[entry++]));
    }
  }
  PetscCall(EqmBlocksRestore(&blocks));
  PetscFunctionReturn(0);
}

/* Make the pattern of a matrix with the given unknowns. Collective. */
PetscErrorCode EqmAssemblyCreate(EqmMesh mesh, const EqmUnknowns *unknowns, EqmStorage storage, EqmAssembly *out)
{
  EqmAssembly assembly;

  PetscFunctionBegin;
  PetscCall(PetscNew(&assembly));
  assembly->mesh = mesh;
  assembly->unknowns = *unknowns;
  assembly->storage = storage;
  PetscCall(CountEntries(assembly));
  PetscCall(MakePattern(assembly));
  PetscCall(FindSlots(assembly));
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
  PetscCall(PetscFree((*assembly)->slot));
  PetscCall(PetscFree(*assembly));
  PetscFunctionReturn(0);
}

/* Clear the rows of one block of vertices. The unknowns of consecutive vertices are consecutive. */
static void ClearRows(const EqmAssembly assembly, const EqmBlocks *blocks, PetscInt b)
{
  const EqmUnknowns *const u = &assembly->unknowns;
  const PetscInt from = assembly->mesh->block_vertex[b], to = assembly->mesh->block_vertex[b + 1];

  if (from == to) return;
  const PetscInt first_row = u->start[from] - u->first, end_row = u->start[to - 1] + u->count[to - 1] - u->first;
  for (int k = 0; k < 2 && blocks->block[k]; k++) {
    for (PetscInt q = blocks->start[k][first_row]; q < blocks->start[k][end_row]; q++) blocks->value[k][q] = 0.;
  }
}

/* Add a cell's matrix to the rows of the vertices from .. to - 1. */
static void AddCell(const EqmAssembly assembly, const EqmBlocks *blocks, PetscInt cell, const PetscReal *matrix,
                    PetscInt from, PetscInt to)
{
  const EqmMesh mesh = assembly->mesh;
  PetscInt list[EQM_MOST_CELL_UNKNOWNS], entry = assembly->cell_start[cell], i = 0;
  const PetscInt n = CellUnknowns(mesh, &assembly->unknowns, cell, list);

  for (PetscInt a = 0; a < mesh->cell_size; a++) {
    const PetscInt v = mesh->cells[mesh->cell_size * cell + a];
    for (PetscInt k = 0; k < assembly->unknowns.count[v]; k++, i++) {
      for (PetscInt j = 0; j < n; j++) {
        if (!Keeps(&assembly->unknowns, assembly->storage, list[i], list[j])) continue;
        const PetscInt slot = assembly->slot[entry++];
        if (v < from || v >= to) continue;
        if (slot >= 0)
          blocks->value[0][slot] += matrix[n * i + j];
        else
          blocks->value[1][-1 - slot] += matrix[n * i + j];
      }
    }
  }
}

/* New values: the sum of the cells' matrices, in a fixed order. Collective. */
PetscErrorCode EqmAssemblyFill(EqmAssembly assembly, EqmCellMatrix cell_matrix, void *context)
{
  const EqmMesh mesh = assembly->mesh;
  EqmBlocks blocks;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_ASSEMBLE));
  PetscCall(EqmBlocksGet(assembly->matrix, &blocks));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) {
    PetscReal matrix[EQM_MOST_CELL_UNKNOWNS * EQM_MOST_CELL_UNKNOWNS];
    ClearRows(assembly, &blocks, b);
    for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
      cell_matrix(context, mesh->block_cell[q], matrix);
      AddCell(assembly, &blocks, mesh->block_cell[q], matrix, mesh->block_vertex[b], mesh->block_vertex[b + 1]);
    }
  }
  PetscCall(EqmBlocksRestore(&blocks));
  PetscCall(MatAssemblyBegin(assembly->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(assembly->matrix, MAT_FINAL_ASSEMBLY));
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
