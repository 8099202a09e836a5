/* Which rank owns which vertex: METIS on the vertex graph where that fits one rank, PT-Scotch on all or
   ranges along a curve where not. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "mesh/diagnose.h"
#include <petscmat.h>
#include <stdlib.h>

/* Larger graphs do not visit one rank unless the user wants it. */
static const PetscInt most_on_root = 1000000;

/* The graph rows of this rank's slab of vertices, neighbours in input numbering. */
static PetscErrorCode SlabGraph(EqmSoup soup, EqmGraph *graph)
{
  EqmVicinity vicinity;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreateCells(soup, &vicinity));
  PetscCall(EqmGraphOfCells(vicinity.num_owned, vicinity.cell_size, vicinity.num_cells, vicinity.cells, graph));
  for (PetscInt q = 0; q < graph->start[graph->num_rows]; q++) {
    graph->neighbor[q] = vicinity.input[graph->neighbor[q]];
  }
  PetscCall(EqmVicinityReset(&vicinity));
  PetscFunctionReturn(0);
}

/* METIS on a graph without the vertices of no cell, such as those of pieces that are left out: they would fill a part.
   degree - per vertex; owners of the vertices left aside are rank 0's. Not collective. */
static PetscErrorCode CutGraph(PetscMPIInt size, PetscInt n, const PetscInt *degree, PetscInt *neighbor,
                               PetscInt *owner)
{
  PetscInt *place, *start, *part, used = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &place, n + 1, &start, n, &part));
  start[0] = 0;
  for (PetscInt i = 0; i < n; i++) {
    place[i] = used;
    if (degree[i] == 0) continue;
    start[used + 1] = start[used] + degree[i];
    used++;
  }
  for (PetscInt q = 0; q < start[used]; q++) neighbor[q] = place[neighbor[q]];
  if (used) PetscCall(EqmRunMetis(size, used, start, neighbor, part));
  for (PetscInt i = 0; i < n; i++) owner[i] = degree[i] ? part[place[i]] : 0;
  PetscCall(PetscFree3(place, start, part));
  PetscFunctionReturn(0);
}

/* METIS is serial: the graph, 44 bytes per vertex, visits rank 0 for the time of the cut, nothing else does. */
static PetscErrorCode PartitionOnRoot(EqmSoup soup, const EqmGraph *graph, PetscInt *owner_of_slab)
{
  const PetscInt num_rows = graph->num_rows;
  PetscInt *degree, *all_degree = NULL, *all_neighbor = NULL, *part = NULL, n = soup->num_vertices;
  PetscInt64 num_edges = 0;
  PetscMPIInt rank, size, *row_count, *row_start, *edge_count, *edge_start, mine[2], (*counts)[2];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(
      PetscMalloc5(size, &row_count, size + 1, &row_start, size, &edge_count, size + 1, &edge_start, size, &counts));
  PetscCall(PetscMPIIntCast(num_rows, &mine[0]));
  PetscCall(PetscMPIIntCast(graph->start[num_rows], &mine[1]));
  PetscCallMPI(MPI_Allgather(mine, 2, MPI_INT, counts, 2, MPI_INT, soup->comm));
  row_start[0] = edge_start[0] = 0;
  for (PetscMPIInt p = 0; p < size; p++) {
    row_count[p] = counts[p][0];
    edge_count[p] = counts[p][1];
    num_edges += edge_count[p];
    if (num_edges > PETSC_MPI_INT_MAX) {
      EqmFail(soup->comm, EQM_ERR_USAGE, "the mesh's graph is too large for METIS on one rank: take -partition auto");
    }
    row_start[p + 1] = row_start[p] + row_count[p];
    edge_start[p + 1] = edge_start[p] + edge_count[p];
  }
  PetscCall(PetscMalloc1(num_rows, &degree));
  for (PetscInt i = 0; i < num_rows; i++) degree[i] = graph->start[i + 1] - graph->start[i];
  if (rank == 0) PetscCall(PetscMalloc3(n, &all_degree, edge_start[size], &all_neighbor, n, &part));
  PetscCallMPI(
      MPI_Gatherv(degree, row_count[rank], MPIU_INT, all_degree, row_count, row_start, MPIU_INT, 0, soup->comm));
  PetscCallMPI(MPI_Gatherv(graph->neighbor, edge_count[rank], MPIU_INT, all_neighbor, edge_count, edge_start, MPIU_INT,
                           0, soup->comm));
  if (rank == 0) PetscCall(CutGraph(size, n, all_degree, all_neighbor, part));
  PetscCallMPI(
      MPI_Scatterv(part, row_count, row_start, MPIU_INT, owner_of_slab, row_count[rank], MPIU_INT, 0, soup->comm));
  if (rank == 0) PetscCall(PetscFree3(all_degree, all_neighbor, part));
  PetscCall(PetscFree(degree));
  PetscCall(PetscFree5(row_count, row_start, edge_count, edge_start, counts));
  PetscFunctionReturn(0);
}

/* By all ranks, through PETSc, which takes the graph's arrays. */
static PetscErrorCode PartitionOnAll(EqmSoup soup, EqmGraph *graph, const char *type, PetscInt *owner_of_slab)
{
  MatPartitioning partitioning;
  const PetscInt *owner;
  Mat adjacency;
  IS owners;

  PetscFunctionBegin;
  PetscCall(MatCreateMPIAdj(soup->comm, graph->num_rows, soup->num_vertices, graph->start, graph->neighbor, NULL,
                            &adjacency));
  graph->start = graph->neighbor = NULL;
  /* threads of PT-Scotch's own would race for the cut: the same mesh would be cut otherwise the next time */
  PetscCheck(!setenv("SCOTCH_PTHREAD_NUMBER", "1", 0), PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for a variable");
  PetscCall(MatPartitioningCreate(soup->comm, &partitioning));
  PetscCall(MatPartitioningSetAdjacency(partitioning, adjacency));
  PetscCall(MatPartitioningSetType(partitioning, type));
  PetscCall(MatPartitioningSetFromOptions(partitioning));
  PetscCall(MatPartitioningApply(partitioning, &owners));
  PetscCall(ISGetIndices(owners, &owner));
  PetscCall(PetscArraycpy(owner_of_slab, owner, graph->num_rows));
  PetscCall(ISRestoreIndices(owners, &owner));
  PetscCall(ISDestroy(&owners));
  PetscCall(MatPartitioningDestroy(&partitioning));
  PetscCall(MatDestroy(&adjacency));
  PetscFunctionReturn(0);
}

/* What works on all ranks is what PETSc was built with, and has integers of its width (CMakeLists.txt). */
enum {
  PARTITION_AUTO,
  PARTITION_METIS,
  PARTITION_CURVE,
  PARTITION_SLAB,
#if defined(EQM_HAVE_PTSCOTCH)
  PARTITION_PTSCOTCH,
#endif
#if defined(PETSC_HAVE_PARMETIS)
  PARTITION_PARMETIS,
#endif
  NUM_PARTITIONS
};
static const char *const partitions[NUM_PARTITIONS] = {
    "auto",     "metis", "curve", "slab",
#if defined(EQM_HAVE_PTSCOTCH)
    "ptscotch",
#endif
#if defined(PETSC_HAVE_PARMETIS)
    "parmetis",
#endif
};

/* For what is too large for one rank. */
#if defined(EQM_HAVE_PTSCOTCH)
static const PetscInt parallel = PARTITION_PTSCOTCH;
#else
static const PetscInt parallel = PARTITION_CURVE;
#endif

PetscErrorCode EqmMeshHelpOptions(PetscOptionItems *PetscOptionsObject)
{
  PetscInt kind = PARTITION_AUTO;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEList(
      "-partition",
      "which rank gets which vertices: metis cuts few edges and takes the mesh's graph to one rank for a moment, "
      "curve takes ranges along Hilbert's curve through space, slab the vertices as the file has them, ptscotch and "
      "parmetis, where PETSc has them, cut the graph on all ranks; auto: metis up to a million vertices, beyond it "
      "ptscotch, or curve where that is not there",
      "EqmMeshCreate", partitions, NUM_PARTITIONS, partitions[kind], &kind, NULL));
  PetscFunctionReturn(0);
}

/* The owning rank of every vertex of this rank's slab. Option: -partition. Collective. */
PetscErrorCode EqmPartitionVertices(EqmSoup soup, EqmLedger ledger, PetscInt *owner_of_slab)
{
  PetscInt kind = PARTITION_AUTO;
  PetscMPIInt rank, size;
  EqmGraph graph;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(PetscOptionsGetEList(NULL, NULL, "-partition", partitions, NUM_PARTITIONS, &kind, NULL));
  if (kind == PARTITION_AUTO) kind = soup->num_vertices > most_on_root ? parallel : PARTITION_METIS;
  if (size == 1 || kind == PARTITION_SLAB) {
    for (PetscInt i = 0; i < soup->vertex_end - soup->vertex_start; i++) owner_of_slab[i] = rank;
    PetscFunctionReturn(0);
  }
  if (kind == PARTITION_CURVE) {
    PetscCall(EqmPartitionAlongCurve(soup, owner_of_slab));
    PetscFunctionReturn(0);
  }
  PetscCall(SlabGraph(soup, &graph));
  PetscCall(EqmEventBegin(ledger, EQM_EVENT_PARTITION));
  if (kind == PARTITION_METIS)
    PetscCall(PartitionOnRoot(soup, &graph, owner_of_slab));
  else
    PetscCall(PartitionOnAll(soup, &graph, partitions[kind], owner_of_slab));
  PetscCall(EqmEventEnd(ledger, EQM_EVENT_PARTITION));
  PetscCall(EqmGraphReset(&graph));
  PetscFunctionReturn(0);
}
