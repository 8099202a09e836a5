/* Blocks of vertices for threads, with the cells around them, and the measures of the cells. */
#include "mesh/build.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"

/* The blocks that a cell's owned vertices lie in, each once; returns how many. */
static PetscInt BlocksOfCell(EqmMesh mesh, const PetscInt *block_of, PetscInt cell, PetscInt blocks[4])
{
  PetscInt count = 0;

  for (PetscInt a = 0; a < mesh->cell_size; a++) {
    const PetscInt v = mesh->cells[mesh->cell_size * cell + a];
    PetscBool seen = PETSC_FALSE;
    if (v >= mesh->num_owned) continue;
    for (PetscInt k = 0; k < count; k++) seen = (PetscBool)(seen || blocks[k] == block_of[v]);
    if (!seen) blocks[count++] = block_of[v];
  }
  return count;
}

/* List for each block of vertices the cells that touch it. Not collective. */
PetscErrorCode EqmMeshMakeBlocks(EqmMesh mesh)
{
  PetscInt blocks[4], *block_of;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(mesh->num_owned, &block_of));
  PetscCall(PetscCalloc1(mesh->num_blocks + 2, &mesh->block_start));
  for (PetscInt b = 0; b < mesh->num_blocks; b++) {
    for (PetscInt v = mesh->block_vertex[b]; v < mesh->block_vertex[b + 1]; v++) block_of[v] = b;
  }
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt count = BlocksOfCell(mesh, block_of, c, blocks);
    for (PetscInt k = 0; k < count; k++) mesh->block_start[blocks[k] + 2]++;
  }
  for (PetscInt b = 0; b < mesh->num_blocks; b++) mesh->block_start[b + 2] += mesh->block_start[b + 1];
  PetscCall(PetscMalloc1(mesh->block_start[mesh->num_blocks + 1], &mesh->block_cell));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt count = BlocksOfCell(mesh, block_of, c, blocks);
    for (PetscInt k = 0; k < count; k++) mesh->block_cell[mesh->block_start[blocks[k] + 1]++] = c;
  }
  PetscCall(PetscFree(block_of));
  PetscFunctionReturn(0);
}

/* A power of two that brings densities beyond 1e100 near one, so that neither masses nor their quotients overflow or
   vanish; 1, and nothing changes, for all others. Collective. */
static PetscErrorCode DensityScale(EqmMesh mesh, const PetscReal *cell_density, PetscReal *scale)
{
  PetscReal largest = 0.;
  int exponent;

  PetscFunctionBegin;
  *scale = 1.;
  for (PetscInt c = 0; c < mesh->num_owned_cells && cell_density; c++) /* a rank without cells may have NULL, too */
    largest = PetscMax(largest, cell_density[c]);
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  (void)frexp(largest, &exponent);
  if (exponent > 332) *scale = ldexp(1., -exponent);
  if (exponent < -332) *scale = ldexp(1., PetscMin(-exponent, 1000));
  PetscFunctionReturn(0);
}

/* Area or volume of every local cell; weights with the density inside, normalised to a sum of one. Collective. */
PetscErrorCode EqmMeshMeasure(EqmMesh mesh, const PetscReal *cell_density)
{
  PetscReal sum = 0., scale;

  PetscFunctionBegin;
  PetscCall(DensityScale(mesh, cell_density, &scale));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &mesh->cell_measure));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &mesh->weight));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;
    const PetscReal *const p = mesh->position;
    mesh->cell_measure[c] = mesh->edge_length ? EqmAreaOfLengths(mesh->edge_length + 3 * c)
                            : mesh->cell_size == 3
                                ? EqmArea3(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2])
                                : PetscAbsReal(EqmVolume(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2], p + 3 * v[3]));
    mesh->weight[c] = mesh->cell_measure[c] * (cell_density ? scale * cell_density[c] : 1.);
    if (c < mesh->num_owned_cells) sum += mesh->weight[c];
  }
  PetscCall(MPIU_Allreduce(&sum, &mesh->measure, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) mesh->weight[c] /= mesh->measure;
  mesh->measure /= scale;
  PetscFunctionReturn(0);
}
