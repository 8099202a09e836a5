/* Matrices from cell matrices: the pattern once, from the graph of the vertices, the values as often as needed. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"
#include "mesh/build.h"

struct _p_EqmAssembly {
  EqmMesh mesh;
  EqmUnknowns unknowns;
  EqmStorage storage;
  Mat matrix;
  PetscInt *place; /* per local cell and ordered pair of its corners: where in the rows of the first the unknowns of the
                      second begin, in the diagonal block; in the other, minus two minus that; ABSENT */
};
enum { ABSENT = -1 };

/* Does this rank keep the entries of vertices v and w? Rows of other ranks are theirs: their ghost layer has the same
   cells. */
static inline PetscBool KeepsPair(const EqmAssembly assembly, PetscInt v, PetscInt w)
{
  const EqmUnknowns *const u = &assembly->unknowns;

  if (v >= assembly->mesh->num_owned || u->count[v] == 0 || u->count[w] == 0) return PETSC_FALSE;
  return (PetscBool)(assembly->storage == EQM_STORE_FULL || u->start[w] <= u->start[v]);
}

/* How many of w's unknowns stand in row k of v. */
static inline PetscInt EntriesOfPair(const EqmAssembly assembly, PetscInt v, PetscInt w, PetscInt k)
{
  return assembly->storage == EQM_STORE_LOWER && v == w ? k + 1 : assembly->unknowns.count[w];
}

/* Append the rows of an owned vertex: `list` is work space for its neighbours and itself, `first` for as many numbers.
 */
static PetscErrorCode AppendRows(const EqmAssembly assembly, const EqmGraph *graph, PetscInt v, PetscInt *list,
                                 PetscInt *first, PetscInt *row_start, PetscInt *column)
{
  const EqmUnknowns *const u = &assembly->unknowns;
  const PetscInt degree = graph->start[v + 1] - graph->start[v];
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt q = 0; q <= degree; q++) {
    const PetscInt w = q < degree ? graph->neighbor[graph->start[v] + q] : v;
    if (!KeepsPair(assembly, v, w)) continue;
    list[n] = w;
    first[n++] = u->start[w];
  }
  PetscCall(PetscSortIntWithArray(n, first, list));
  for (PetscInt k = 0; k < u->count[v]; k++) {
    const PetscInt row = u->start[v] - u->first + k;
    PetscInt end = row_start[row];
    for (PetscInt q = 0; q < n; q++) {
      const PetscInt entries = EntriesOfPair(assembly, v, list[q], k);
      for (PetscInt j = 0; j < entries; j++) column[end++] = first[q] + j;
    }
    row_start[row + 1] = end;
  }
  PetscFunctionReturn(0);
}

/* Allocate all rows: no row of a vertex is longer than its neighbours' and its own unknowns. */
static PetscInt MostEntries(const EqmAssembly assembly, const EqmGraph *graph, PetscInt *most_neighbors)
{
  const EqmUnknowns *const u = &assembly->unknowns;
  PetscInt entries = 0;

  *most_neighbors = 0;
  for (PetscInt v = 0; v < assembly->mesh->num_owned; v++) {
    const PetscInt degree = graph->start[v + 1] - graph->start[v];
    PetscInt columns = KeepsPair(assembly, v, v) ? u->count[v] : 0;
    for (PetscInt q = graph->start[v]; q < graph->start[v + 1]; q++) {
      if (KeepsPair(assembly, v, graph->neighbor[q])) columns += u->count[graph->neighbor[q]];
    }
    entries += columns * u->count[v];
    *most_neighbors = PetscMax(*most_neighbors, degree + 1);
  }
  return entries;
}

/* Give the matrix these rows; on one rank without setting entry by entry. Values come with EqmAssemblyFill. */
static PetscErrorCode TakePattern(Mat matrix, PetscInt num_rows, const PetscInt *row_start, PetscInt *column)
{
  PetscMPIInt size;
  PetscInt *length;

  PetscFunctionBegin;
  PetscCall(MatSetType(matrix, MATAIJ));
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)matrix), &size));
  if (size > 1) {
    PetscCall(MatMPIAIJSetPreallocationCSR(matrix, row_start, column, NULL));
    PetscFunctionReturn(0);
  }
  PetscCall(PetscMalloc1(num_rows, &length));
  for (PetscInt i = 0; i < num_rows; i++) length[i] = row_start[i + 1] - row_start[i];
  PetscCall(MatSeqAIJSetPreallocation(matrix, 0, length));
  PetscCall(PetscFree(length));
  PetscCall(MatSeqAIJSetColumnIndices(matrix, column));
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

static PetscErrorCode MakePattern(EqmAssembly assembly)
{
  const EqmMesh mesh = assembly->mesh;
  const EqmUnknowns *const unknowns = &assembly->unknowns;
  PetscInt *row_start, *column, *list, *first, most_neighbors;
  EqmGraph graph;

  PetscFunctionBegin;
  PetscCall(EqmGraphOfCells(mesh->num_owned, mesh->cell_size, mesh->num_local_cells, mesh->cells, &graph));
  const PetscInt most_entries = MostEntries(assembly, &graph, &most_neighbors);
  PetscCall(PetscMalloc4(unknowns->num_owned + 1, &row_start, most_entries, &column, most_neighbors, &list,
                         most_neighbors, &first));
  row_start[0] = 0;
  for (PetscInt v = 0; v < mesh->num_owned; v++)
    PetscCall(AppendRows(assembly, &graph, v, list, first, row_start, column));
  PetscCall(EqmGraphReset(&graph));
  PetscCall(MatCreate(mesh->comm, &assembly->matrix));
  PetscCall(MatSetSizes(assembly->matrix, unknowns->num_owned, unknowns->num_owned, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(TakePattern(assembly->matrix, unknowns->num_owned, row_start, column));
  PetscCall(PetscFree4(row_start, column, list, first));
  PetscFunctionReturn(0);
}

/* Access the blocks of a matrix; release them with EqmBlocksRestore. Collective. */
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

/* Where a column stands among n > 0 sorted ones, ABSENT if it is not one of them. Halves without branches, which
   nobody could foresee, as this is done for all pairs of corners. */
static inline PetscInt FindColumn(PetscInt column, PetscInt n, const PetscInt *sorted)
{
  PetscInt begin = 0;

  while (n > 1) {
    const PetscInt half = n / 2;
    begin = sorted[begin + half] <= column ? begin + half : begin;
    n -= half;
  }
  return sorted[begin] == column ? begin : ABSENT;
}

/* Where in the rows of vertex v the unknowns of w begin; ABSENT if the pattern is without them. */
static PetscInt FindPlace(const EqmAssembly assembly, const EqmBlocks *blocks, PetscInt v, PetscInt w)
{
  const EqmUnknowns *const u = &assembly->unknowns;
  const int b = w < assembly->mesh->num_owned ? 0 : 1;
  const PetscInt row = u->start[v] - u->first, begin = blocks->start[b][row], n = blocks->start[b][row + 1] - begin;
  PetscInt column = u->start[w] - u->first;

  if (b == 1) column = FindColumn(u->start[w], blocks->num_global_columns, blocks->global_column);
  const PetscInt place = n > 0 && column != ABSENT ? FindColumn(column, n, blocks->column[b] + begin) : ABSENT;
  return b == 1 && place != ABSENT ? -2 - place : place;
}

static PetscErrorCode FindPlaces(EqmAssembly assembly)
{
  const EqmMesh mesh = assembly->mesh;
  const PetscInt n = mesh->cell_size, count = n * n * mesh->num_local_cells;
  PetscInt num_missing = 0;
  EqmBlocks blocks;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &assembly->place));
  PetscCall(EqmBlocksGet(assembly->matrix, &blocks));
#pragma omp parallel for schedule(static) reduction(+ : num_missing)
  for (PetscInt k = 0; k < count; k++) {
    const PetscInt *const corner = mesh->cells + n * (k / (n * n));
    const PetscInt v = corner[k / n % n], w = corner[k % n];
    const PetscBool keeps = KeepsPair(assembly, v, w);
    assembly->place[k] = keeps ? FindPlace(assembly, &blocks, v, w) : ABSENT;
    if (keeps && assembly->place[k] == ABSENT) num_missing++;
  }
  PetscCall(EqmBlocksRestore(&blocks));
  PetscCheck(num_missing == 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "%" PetscInt_FMT " entries are missing in the pattern",
             num_missing);
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
  PetscCall(MakePattern(assembly));
  PetscCall(FindPlaces(assembly));
  *out = assembly;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmAssemblyDestroy(EqmAssembly *assembly)
{
  PetscFunctionBegin;
  if (!*assembly) PetscFunctionReturn(0);
  PetscCall(MatDestroy(&(*assembly)->matrix));
  PetscCall(PetscFree((*assembly)->place));
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
  const EqmUnknowns *const u = &assembly->unknowns;
  const PetscInt corners = assembly->mesh->cell_size, *const v = assembly->mesh->cells + corners * cell;
  PetscInt first[5] = {0};

  for (PetscInt a = 0; a < corners; a++) first[a + 1] = first[a] + u->count[v[a]];
  for (PetscInt a = 0; a < corners; a++) {
    if (v[a] < from || v[a] >= to) continue;
    for (PetscInt b = 0; b < corners; b++) {
      const PetscInt place = assembly->place[corners * (corners * cell + a) + b];
      const int block = place >= 0 ? 0 : 1;
      if (place == ABSENT) continue;
      for (PetscInt i = 0; i < u->count[v[a]]; i++) {
        const PetscReal *const entry = matrix + first[corners] * (first[a] + i) + first[b];
        PetscScalar *const value = blocks->value[block] + blocks->start[block][u->start[v[a]] - u->first + i] +
                                   (block == 0 ? place : -2 - place);
        const PetscInt entries = EntriesOfPair(assembly, v[a], v[b], i);
        for (PetscInt j = 0; j < entries; j++) value[j] += entry[j];
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
