/* The steps from a soup to a distributed mesh; private to this folder. */
#ifndef EQM_MESH_BUILD_H
#define EQM_MESH_BUILD_H

#include <equimap/mesh.h>
#include "mesh/cells.h"

/* A graph in compressed rows. */
typedef struct {
  PetscInt num_rows;
  PetscInt *start;    /* num_rows + 1 */
  PetscInt *neighbor; /* start[num_rows] */
} EqmGraph;

PETSC_INTERN PetscErrorCode EqmMeshNumberInOrder(EqmMesh mesh, PetscInt num_leaves, const PetscInt *leaf,
                                                 PetscInt *number);
/* First row of a rank's slab of `total` rows: contiguous, in rank order, sizes that differ by one at most. Not
   collective. */
PETSC_INTERN PetscInt EqmSlabStart(PetscInt total, PetscMPIInt rank, PetscMPIInt size);
PETSC_INTERN PetscErrorCode EqmSoupComputeChecksum(EqmSoup soup);
PETSC_INTERN PetscErrorCode EqmSoupComputeIdentity(EqmSoup soup, PetscInt64 *identity);
PETSC_INTERN PetscErrorCode EqmSoupSlabSF(EqmSoup soup, PetscInt num_leaves, const PetscInt *vertices, PetscSF *sf);
PETSC_INTERN PetscErrorCode EqmGraphOfCells(PetscInt num_rows, PetscInt cell_size, PetscInt num_cells,
                                            const PetscInt *cells, EqmGraph *graph);
PETSC_INTERN PetscErrorCode EqmGraphReset(EqmGraph *graph);
PETSC_INTERN PetscErrorCode EqmPartitionVertices(EqmSoup soup, EqmLedger ledger, PetscInt *owner_of_slab);
PETSC_INTERN PetscErrorCode EqmPartitionAlongCurve(EqmSoup soup, PetscInt *owner_of_slab);
PETSC_INTERN PetscErrorCode EqmOrderCuthillMcKee(const EqmGraph *graph, PetscInt *new_number);
PETSC_INTERN PetscErrorCode EqmRunMetis(PetscInt num_parts, PetscInt n, PetscInt *start, PetscInt *neighbor,
                                        PetscInt *part);
PETSC_INTERN PetscErrorCode EqmDissect(PetscInt n, PetscInt *degree_then_start, PetscInt *neighbor, PetscInt *order);
PETSC_INTERN PetscInt EqmNumBlocks(PetscInt cell_size, PetscInt num_vertices);
PETSC_INTERN PetscErrorCode EqmCutBlocks(PetscInt num_vertices, PetscInt num_blocks, PetscInt *block_vertex);
PETSC_INTERN PetscErrorCode EqmOrderBlocks(const EqmGraph *graph, PetscInt num_blocks, PetscInt *new_number,
                                           PetscInt *block_vertex);
PETSC_INTERN PetscErrorCode EqmMeshFindBoundary(EqmMesh mesh);
PETSC_INTERN PetscErrorCode EqmMeshMakeBlocks(EqmMesh mesh);
PETSC_INTERN PetscErrorCode EqmMeshMeasure(EqmMesh mesh, const PetscReal *cell_density);

#endif
