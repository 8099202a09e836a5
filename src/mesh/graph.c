/* Vertex graphs and the orderings made of them. */
#include "mesh/build.h"
#include <petscmat.h>

/* Cells around each row vertex, as compressed rows. Vertices >= num_rows are ignored. */
static PetscErrorCode CellsAround(PetscInt num_rows, PetscInt cell_size, PetscInt num_cells, const PetscInt *cells,
                                  PetscInt **start, PetscInt **around)
{
  PetscInt *first, *list;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(num_rows + 2, &first));
  for (PetscInt k = 0; k < cell_size * num_cells; k++) {
    if (cells[k] < num_rows) first[cells[k] + 2]++;
  }
  for (PetscInt i = 0; i < num_rows; i++) first[i + 2] += first[i + 1];
  PetscCall(PetscMalloc1(first[num_rows + 1], &list));
  for (PetscInt c = 0; c < num_cells; c++) {
    for (PetscInt a = 0; a < cell_size; a++) {
      const PetscInt v = cells[cell_size * c + a];
      if (v < num_rows) list[first[v + 1]++] = c;
    }
  }
  *start = first;
  *around = list;
  PetscFunctionReturn(0);
}

/* The graph of vertices that share a cell: rows for the vertices 0 .. num_rows-1, neighbours among all vertices that
   the cells name, without the vertex itself, each once. Not collective. */
PetscErrorCode EqmGraphOfCells(PetscInt num_rows, PetscInt cell_size, PetscInt num_cells, const PetscInt *cells,
                               EqmGraph *graph)
{
  PetscInt *first, *around, *mark, num_vertices = num_rows, count = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < cell_size * num_cells; k++) num_vertices = PetscMax(num_vertices, cells[k] + 1);
  PetscCall(CellsAround(num_rows, cell_size, num_cells, cells, &first, &around));
  graph->num_rows = num_rows;
  PetscCall(PetscMalloc1(num_rows + 1, &graph->start));
  PetscCall(PetscMalloc1((cell_size - 1) * first[num_rows], &graph->neighbor));
  PetscCall(PetscMalloc1(num_vertices, &mark));
  for (PetscInt v = 0; v < num_vertices; v++) mark[v] = -1;
  for (PetscInt i = 0; i < num_rows; i++) {
    graph->start[i] = count;
    mark[i] = i;
    for (PetscInt q = first[i]; q < first[i + 1]; q++) {
      for (PetscInt a = 0; a < cell_size; a++) {
        const PetscInt v = cells[cell_size * around[q] + a];
        if (mark[v] == i) continue;
        mark[v] = i;
        graph->neighbor[count++] = v;
      }
    }
  }
  graph->start[num_rows] = count;
  PetscCall(PetscRealloc(sizeof(PetscInt) * (size_t)PetscMax(count, 1), &graph->neighbor));
  PetscCall(PetscFree(mark));
  PetscCall(PetscFree(around));
  PetscCall(PetscFree(first));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmGraphReset(EqmGraph *graph)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(graph->start));
  PetscCall(PetscFree(graph->neighbor));
  graph->num_rows = 0;
  PetscFunctionReturn(0);
}

/* Reverse Cuthill-McKee: neighbours in the mesh become neighbours in memory, which a random numbering costs a factor of
   ten in the element loops. Neighbours outside the rows are left aside. `new_number` per row. Not collective. */
PetscErrorCode EqmOrderCuthillMcKee(const EqmGraph *graph, PetscInt *new_number)
{
  const PetscInt n = graph->num_rows;
  PetscInt *start, *column, count = 0;
  PetscReal *value;
  const PetscInt *order;
  Mat adjacency;
  IS rows, columns;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n + 1, &start, graph->start[n] + n, &column));
  for (PetscInt i = 0; i < n; i++) {
    start[i] = count;
    column[count++] = i;
    for (PetscInt q = graph->start[i]; q < graph->start[i + 1]; q++) {
      if (graph->neighbor[q] < n) column[count++] = graph->neighbor[q];
    }
    PetscCall(PetscSortInt(count - start[i], column + start[i]));
  }
  start[n] = count;
  PetscCall(PetscCalloc1(count, &value));
  PetscCall(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, start, column, value, &adjacency));
  PetscCall(MatGetOrdering(adjacency, MATORDERINGRCM, &rows, &columns));
  PetscCall(ISGetIndices(rows, &order));
  for (PetscInt k = 0; k < n; k++) new_number[order[k]] = k;
  PetscCall(ISRestoreIndices(rows, &order));
  PetscCall(ISDestroy(&rows));
  PetscCall(ISDestroy(&columns));
  PetscCall(MatDestroy(&adjacency));
  PetscCall(PetscFree(value));
  PetscCall(PetscFree2(start, column));
  PetscFunctionReturn(0);
}

/* Enough blocks for the threads of a large node to share, few enough that not many cells are visited twice. */
enum { MOST_BLOCKS = 64, LEAST_BLOCK_OF_SURFACE = 256, LEAST_BLOCK_OF_SOLID = 1024 };

/* How many blocks the vertices are cut into. The number depends on the mesh alone, so that every sum has one order for
   any number of threads. Not collective. */
PetscInt EqmNumBlocks(PetscInt cell_size, PetscInt num_vertices)
{
  const PetscInt least = cell_size == 3 ? LEAST_BLOCK_OF_SURFACE : LEAST_BLOCK_OF_SOLID;

  return PetscMax(1, PetscMin(MOST_BLOCKS, num_vertices / least));
}

/* Equal shares of the numbering: compact on a surface, whose Cuthill-McKee fronts are lines. Not collective. */
PetscErrorCode EqmCutBlocks(PetscInt num_vertices, PetscInt num_blocks, PetscInt *block_vertex)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b <= num_blocks; b++) {
    block_vertex[b] = (PetscInt)((PetscInt64)num_vertices * b / num_blocks);
  }
  PetscFunctionReturn(0);
}

/* Blocks that METIS cuts, for solids: their fronts are surfaces, and shares of the numbering would be thin slices, each
   cell in two of them. Vertices of a block become neighbours in `new_number` and keep their order; blocks follow each
   other as their first vertices did. Not collective. */
PetscErrorCode EqmOrderBlocks(const EqmGraph *graph, PetscInt num_blocks, PetscInt *new_number, PetscInt *block_vertex)
{
  const PetscInt n = graph->num_rows;
  PetscInt *start, *neighbor, *part, *order, *block, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(n + 1, &start, graph->start[n], &neighbor, n, &part, n, &order, num_blocks, &block));
  for (PetscInt i = 0; i < n; i++) {
    start[i] = count;
    for (PetscInt q = graph->start[i]; q < graph->start[i + 1]; q++) {
      if (graph->neighbor[q] < n) neighbor[count++] = graph->neighbor[q];
    }
    order[new_number[i]] = i;
  }
  start[n] = count;
  PetscCall(EqmRunMetis(num_blocks, n, start, neighbor, part));
  for (PetscInt b = 0; b < num_blocks; b++) block[b] = -1;
  PetscCall(PetscArrayzero(block_vertex, num_blocks + 1));
  count = 0;
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt p = part[order[k]];
    if (block[p] < 0) block[p] = count++;
    block_vertex[block[p] + 1]++;
  }
  for (PetscInt b = 0; b < num_blocks; b++) block_vertex[b + 1] += block_vertex[b];
  for (PetscInt k = 0; k < n; k++) new_number[order[k]] = block_vertex[block[part[order[k]]]]++;
  for (PetscInt b = num_blocks; b > 0; b--) block_vertex[b] = block_vertex[b - 1];
  block_vertex[0] = 0;
  PetscCall(PetscFree5(start, neighbor, part, order, block));
  PetscFunctionReturn(0);
}
