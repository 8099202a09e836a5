/* What the threads share out: blocks of vertices with the cells they look at, and the measures of the cells. */
#include "mesh/build.h"
#include "energy/kernel.h"

/* Enough blocks for the threads of a large node to share, few enough that only a few per cent of the cells are visited
   twice. The number depends on the mesh alone, so that every sum has one order. */
enum { MOST_BLOCKS = 64, LEAST_BLOCK = 256 };

static PetscInt BlockOf(EqmMesh mesh, PetscInt vertex)
{
  PetscInt low = 0, high = mesh->num_blocks;

  while (high - low > 1) {
    const PetscInt middle = (low + high) / 2;
    if (mesh->block_vertex[middle] <= vertex)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* The blocks that a cell's owned vertices lie in, each once; returns how many. */
static PetscInt BlocksOfCell(EqmMesh mesh, PetscInt cell, PetscInt blocks[4])
{
  PetscInt count = 0;

  for (PetscInt a = 0; a < mesh->cell_size; a++) {
    const PetscInt v = mesh->cells[mesh->cell_size * cell + a];
    PetscBool seen = PETSC_FALSE;
    if (v >= mesh->num_owned) continue;
    const PetscInt block = BlockOf(mesh, v);
    for (PetscInt k = 0; k < count; k++) seen = (PetscBool)(seen || blocks[k] == block);
    if (!seen) blocks[count++] = block;
  }
  return count;
}

/* Cut the owned vertices into contiguous blocks and list for each the cells that touch it. Not collective. */
PetscErrorCode EqmMeshMakeBlocks(EqmMesh mesh)
{
  PetscInt blocks[4];

  PetscFunctionBegin;
  mesh->num_blocks = PetscMax(1, PetscMin(MOST_BLOCKS, mesh->num_owned / LEAST_BLOCK));
  PetscCall(PetscMalloc1(mesh->num_blocks + 1, &mesh->block_vertex));
  for (PetscInt b = 0; b <= mesh->num_blocks; b++) {
    mesh->block_vertex[b] = (PetscInt)((PetscInt64)mesh->num_owned * b / mesh->num_blocks);
  }
  PetscCall(PetscCalloc1(mesh->num_blocks + 2, &mesh->block_start));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt count = BlocksOfCell(mesh, c, blocks);
    for (PetscInt k = 0; k < count; k++) mesh->block_start[blocks[k] + 2]++;
  }
  for (PetscInt b = 0; b < mesh->num_blocks; b++) mesh->block_start[b + 2] += mesh->block_start[b + 1];
  PetscCall(PetscMalloc1(mesh->block_start[mesh->num_blocks + 1], &mesh->block_cell));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt count = BlocksOfCell(mesh, c, blocks);
    for (PetscInt k = 0; k < count; k++) mesh->block_cell[mesh->block_start[blocks[k] + 1]++] = c;
  }
  PetscFunctionReturn(0);
}

/* Area or volume of every local cell; weights with the density inside, normalised to a sum of one. Collective. */
PetscErrorCode EqmMeshMeasure(EqmMesh mesh, const PetscReal *cell_density)
{
  PetscReal sum = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_local_cells, &mesh->shape));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &mesh->weight));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;
    const PetscReal *const p = mesh->position;
    mesh->shape[c] = mesh->cell_size == 3
                         ? EqmArea3(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2])
                         : PetscAbsReal(EqmVolume(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2], p + 3 * v[3]));
    mesh->weight[c] = mesh->shape[c] * (cell_density ? cell_density[c] : 1.);
    if (c < mesh->num_owned_cells) sum += mesh->weight[c];
  }
  PetscCall(MPIU_Allreduce(&sum, &mesh->measure, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) mesh->weight[c] /= mesh->measure;
  PetscFunctionReturn(0);
}
