/* Which rank owns which vertex: METIS on the vertex graph. */
#include "mesh/build.h"
#include <metis.h>

/* The graph rows of this rank's slab of vertices, neighbours in input numbering. */
static PetscErrorCode SlabGraph(EqmSoup soup, EqmGraph *graph)
{
  const PetscInt num_rows = soup->vertex_end - soup->vertex_start, cs = soup->cell_size;
  PetscInt *owner, *cells, *others, num_others = 0;
  PetscMPIInt rank;
  EqmStars stars;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMalloc1(num_rows, &owner));
  for (PetscInt i = 0; i < num_rows; i++) owner[i] = rank;
  PetscCall(EqmStarsCollect(soup, owner, &stars));
  PetscCall(PetscFree(owner));
  /* local numbers: the slab first, then the other vertices that its cells name */
  PetscCall(PetscMalloc2(cs * stars.num_cells, &cells, cs * stars.num_cells, &others));
  for (PetscInt c = 0; c < stars.num_cells; c++) {
    for (PetscInt a = 0; a < cs; a++) {
      const PetscInt v = stars.records[stars.width * c + 1 + a];
      cells[cs * c + a] = v;
      if (v < soup->vertex_start || v >= soup->vertex_end) others[num_others++] = v;
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&num_others, others));
  for (PetscInt k = 0; k < cs * stars.num_cells; k++) {
    PetscInt place = cells[k] - soup->vertex_start;
    if (cells[k] < soup->vertex_start || cells[k] >= soup->vertex_end) {
      PetscCall(PetscFindInt(cells[k], num_others, others, &place));
      place += num_rows;
    }
    cells[k] = place;
  }
  PetscCall(EqmGraphOfCells(num_rows, cs, stars.num_cells, cells, graph));
  for (PetscInt q = 0; q < graph->start[num_rows]; q++) {
    const PetscInt v = graph->neighbor[q];
    graph->neighbor[q] = v < num_rows ? v + soup->vertex_start : others[v - num_rows];
  }
  PetscCall(PetscFree2(cells, others));
  PetscCall(EqmStarsReset(&stars));
  PetscFunctionReturn(0);
}

/* Cut a graph into parts of equal size with few edges between them. Not collective. */
PetscErrorCode EqmRunMetis(PetscInt num_parts, PetscInt n, PetscInt *start, PetscInt *neighbor, PetscInt *part)
{
  idx_t num_rows = (idx_t)n, num_constraints = 1, parts = (idx_t)num_parts, cut;
  int result;

  PetscFunctionBegin;
  if (num_parts == 1) { /* METIS divides by zero there */
    PetscCall(PetscArrayzero(part, n));
    PetscFunctionReturn(0);
  }
  PetscCheck(sizeof(idx_t) == sizeof(PetscInt), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "METIS and PETSc were built with integers of different sizes; build both with the same");
  result = METIS_PartGraphKway(&num_rows, &num_constraints, (idx_t *)start, (idx_t *)neighbor, NULL, NULL, NULL, &parts,
                               NULL, NULL, NULL, &cut, (idx_t *)part);
  PetscCheck(result == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS_PartGraphKway failed with code %d", result);
  PetscFunctionReturn(0);
}

/* METIS is serial: the graph, 28 bytes per vertex, visits rank 0 for the time of the cut, nothing else does. */
static PetscErrorCode PartitionOnRoot(EqmSoup soup, const EqmGraph *graph, PetscInt *owner_of_slab)
{
  const PetscInt num_rows = graph->num_rows;
  PetscInt *degree, *all_start = NULL, *all_neighbor = NULL, *part = NULL, n = soup->num_vertices;
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
    row_start[p + 1] = row_start[p] + row_count[p];
    edge_start[p + 1] = edge_start[p] + edge_count[p];
  }
  PetscCall(PetscMalloc1(num_rows, &degree));
  for (PetscInt i = 0; i < num_rows; i++) degree[i] = graph->start[i + 1] - graph->start[i];
  if (rank == 0) PetscCall(PetscMalloc3(n + 1, &all_start, edge_start[size], &all_neighbor, n, &part));
  PetscCallMPI(
      MPI_Gatherv(degree, row_count[rank], MPIU_INT, all_start, row_count, row_start, MPIU_INT, 0, soup->comm));
  PetscCallMPI(MPI_Gatherv(graph->neighbor, edge_count[rank], MPIU_INT, all_neighbor, edge_count, edge_start, MPIU_INT,
                           0, soup->comm));
  if (rank == 0) {
    PetscInt sum = 0;
    for (PetscInt i = 0; i < n; i++) {
      const PetscInt d = all_start[i];
      all_start[i] = sum;
      sum += d;
    }
    all_start[n] = sum;
    PetscCall(EqmRunMetis(size, n, all_start, all_neighbor, part));
  }
  PetscCallMPI(
      MPI_Scatterv(part, row_count, row_start, MPIU_INT, owner_of_slab, row_count[rank], MPIU_INT, 0, soup->comm));
  if (rank == 0) PetscCall(PetscFree3(all_start, all_neighbor, part));
  PetscCall(PetscFree(degree));
  PetscCall(PetscFree5(row_count, row_start, edge_count, edge_start, counts));
  PetscFunctionReturn(0);
}

enum { PARTITION_METIS, PARTITION_SLAB, NUM_PARTITIONS };
static const char *const partitions[NUM_PARTITIONS] = {"metis", "slab"};

/* EqmMeshAskOptions - ask for the options of EqmMeshCreate, with help: -partition.

   Collective, between PetscOptionsBegin and PetscOptionsEnd. */
PetscErrorCode EqmMeshAskOptions(PetscOptionItems *PetscOptionsObject)
{
  PetscInt kind = PARTITION_METIS;

  PetscFunctionBegin;
  PetscCall(PetscOptionsEList("-partition",
                              "which rank gets which vertices: metis cuts few edges and takes the mesh's graph to one "
                              "rank for a moment, slab takes the vertices as the file has them",
                              "EqmMeshCreate", partitions, NUM_PARTITIONS, partitions[kind], &kind, NULL));
  PetscFunctionReturn(0);
}

/* The owning rank of every vertex of this rank's slab. Option: -partition. Collective. */
PetscErrorCode EqmPartitionVertices(EqmSoup soup, EqmLedger ledger, PetscInt *owner_of_slab)
{
  PetscInt kind = PARTITION_METIS;
  PetscMPIInt rank, size;
  EqmGraph graph;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  PetscCall(PetscOptionsGetEList(NULL, NULL, "-partition", partitions, NUM_PARTITIONS, &kind, NULL));
  if (size == 1 || kind == PARTITION_SLAB) {
    for (PetscInt i = 0; i < soup->vertex_end - soup->vertex_start; i++) owner_of_slab[i] = rank;
    PetscFunctionReturn(0);
  }
  PetscCall(SlabGraph(soup, &graph));
  PetscCall(EqmEventBegin(ledger, EQM_EVENT_PARTITION));
  PetscCall(PartitionOnRoot(soup, &graph, owner_of_slab));
  PetscCall(EqmEventEnd(ledger, EQM_EVENT_PARTITION));
  PetscCall(EqmGraphReset(&graph));
  PetscFunctionReturn(0);
}
