#include "linalg/levelcells.h"
#include "base/rows.h"
#include "linalg/levelrows.h"
#include "mesh/mesh_private.h"

PetscErrorCode EqmLevelCellsCreate(EqmMesh mesh, PetscInt num, const PetscInt *order, EqmLevelCells *cells)
{
  PetscFunctionBegin;
  *cells = (EqmLevelCells){.order = order};
  if (mesh->size > 1) PetscCall(EqmRowsCreateSF(mesh->comm, mesh->num_owned_cells, num, order, &cells->sf));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLevelCellsDestroy(EqmLevelCells *cells)
{
  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&cells->sf));
  PetscCall(PetscFree(cells->packed));
  PetscFunctionReturn(0);
}

/* How many unknowns the corners of a cell have. */
static PetscInt SizeOfCell(const unsigned char *count, const PetscInt *v)
{
  return count[v[0]] + count[v[1]] + count[v[2]];
}

PetscErrorCode EqmLevelCellsSend(EqmLinear linear, EqmLevelCells *cells)
{
  const EqmMesh mesh = linear->mesh;
  PetscInt num;
  PetscReal *mine;

  PetscFunctionBegin;
  if (!cells->sf) PetscFunctionReturn(0);
  PetscCall(PetscSFGetGraph(cells->sf, NULL, &num, NULL, NULL));
  PetscCall(PetscMalloc1((size_t)EQM_PACKED_TRIANGLE * num, &cells->packed));
  PetscCall(PetscCalloc1((size_t)EQM_PACKED_TRIANGLE * mesh->num_owned_cells, &mine));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) {
    PetscReal matrix[EQM_MOST_TRIANGLE_SIZE * EQM_MOST_TRIANGLE_SIZE];
    linear->cell_matrix(linear->context, c, matrix);
    EqmTrianglePack(SizeOfCell(linear->unknowns.count, mesh->cells + 3 * c), matrix,
                    mine + (size_t)EQM_PACKED_TRIANGLE * c);
  }
  PetscCall(EqmRowsToLeaves(cells->sf, EQM_PACKED_TRIANGLE, mine, cells->packed));
  PetscCall(PetscFree(mine));
  PetscFunctionReturn(0);
}

static void AssemblePiece(EqmLinear linear, const EqmLevelCells *cells, PetscInt piece, EqmLevelSystem *system)
{
  static const PetscReal nothing[EQM_MOST_TRIANGLE_SIZE] = {0., 0., 0., 0., 0., 0.};
  const EqmLevelPieces *const pieces = &system->cells;

  for (PetscInt q = pieces->start[piece]; q < pieces->start[piece + 1]; q++) {
    const PetscInt c = pieces->item[q];
    PetscReal matrix[EQM_MOST_TRIANGLE_SIZE * EQM_MOST_TRIANGLE_SIZE];
    if (cells->packed)
      EqmTriangleUnpack(SizeOfCell(system->count, system->level->cells + 3 * c),
                        cells->packed + (size_t)EQM_PACKED_TRIANGLE * c, matrix);
    else
      linear->cell_matrix(linear->context, cells->order[c], matrix);
    EqmLevelSystemAdd(system, c, matrix, nothing);
  }
}

PetscErrorCode EqmLevelCellsAssemble(EqmLinear linear, EqmLevelCells *cells, EqmLevelSystem *system, PetscBool *success)
{
  const PetscInt count = system->cells.count;

  PetscFunctionBegin;
  PetscCall(EqmLevelSystemClear(system));
#pragma omp parallel for schedule(dynamic) if (count > 1)
  for (PetscInt k = 0; k < count; k++) AssemblePiece(linear, cells, k, system);
  AssemblePiece(linear, cells, count, system); /* the cells between pieces */
  PetscCall(PetscFree(cells->packed));
  PetscCall(EqmLevelSystemEnd(system, linear->diagonal_factor - 1., success));
  PetscFunctionReturn(0);
}
