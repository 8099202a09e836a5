/* The distributed mesh: made from a soup, destroyed, its ghosts refreshed. */
#include "mesh/build.h"
#include "mesh/mesh_private.h"
#include "base/fatal.h"
#include "base/rows.h"
#include "geometry/simplex.h"

/* Local numbers: the input numbers of owned vertices (sorted), then those of the ghosts. */
static PetscErrorCode CollectVertices(const EqmStars *stars, PetscInt rank, PetscInt *num_owned, PetscInt **owned,
                                      PetscInt *num_ghosts, PetscInt **ghosts)
{
  const PetscInt cs = stars->cell_size, n = cs * stars->num_cells;
  PetscInt no = 0, ng = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, owned));
  PetscCall(PetscMalloc1(n, ghosts));
  for (PetscInt c = 0; c < stars->num_cells; c++) {
    const PetscInt *const record = stars->records + stars->width * c;
    for (PetscInt a = 0; a < cs; a++) {
      if (record[1 + cs + a] == rank)
        (*owned)[no++] = record[1 + a];
      else
        (*ghosts)[ng++] = record[1 + a];
    }
  }
  PetscCall(PetscSortRemoveDupsInt(&no, *owned));
  PetscCall(PetscSortRemoveDupsInt(&ng, *ghosts));
  *num_owned = no;
  *num_ghosts = ng;
  PetscFunctionReturn(0);
}

/* Cells in terms of places in the sorted lists: owned first, ghosts behind. */
static PetscErrorCode LocalCells(const EqmStars *stars, PetscInt num_owned, const PetscInt *owned, PetscInt num_ghosts,
                                 const PetscInt *ghosts, PetscInt rank, PetscInt *cells)
{
  const PetscInt cs = stars->cell_size;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < stars->num_cells; c++) {
    const PetscInt *const record = stars->records + stars->width * c;
    for (PetscInt a = 0; a < cs; a++) {
      const PetscBool mine = (PetscBool)(record[1 + cs + a] == rank);
      PetscInt place;
      PetscCall(PetscFindInt(record[1 + a], mine ? num_owned : num_ghosts, mine ? owned : ghosts, &place));
      cells[cs * c + a] = mine ? place : place + num_owned;
    }
  }
  PetscFunctionReturn(0);
}

/* Global numbers of the ghosts: owners send them to the slabs of the input numbering, from which the ghosts fetch them.
 */
static PetscErrorCode NumberGhosts(EqmMesh mesh, EqmSoup soup, PetscInt num_ghosts, const PetscInt *ghost_input,
                                   PetscInt *ghost_global)
{
  PetscInt *directory, *mine;
  PetscSF to_slab, from_slab;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(soup->vertex_end - soup->vertex_start, &directory, mesh->num_owned, &mine));
  for (PetscInt i = 0; i < mesh->num_owned; i++) mine[i] = mesh->vertex_start + i;
  PetscCall(EqmSoupSlabSF(soup, mesh->num_owned, mesh->vertex_input, &to_slab));
  PetscCall(PetscSFReduceBegin(to_slab, MPIU_INT, mine, directory, MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(to_slab, MPIU_INT, mine, directory, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&to_slab));
  PetscCall(EqmSoupSlabSF(soup, num_ghosts, ghost_input, &from_slab));
  PetscCall(PetscSFBcastBegin(from_slab, MPIU_INT, directory, ghost_global, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(from_slab, MPIU_INT, directory, ghost_global, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&from_slab));
  PetscCall(PetscFree2(directory, mine));
  PetscFunctionReturn(0);
}

/* New numbers of the owned vertices, by reverse Cuthill-McKee, and the blocks that threads work on. */
static PetscErrorCode OrderOwned(EqmMesh mesh, PetscInt num_cells, const PetscInt *cells, PetscInt *new_number)
{
  EqmGraph graph;

  PetscFunctionBegin;
  PetscCall(EqmGraphOfCells(mesh->num_owned, mesh->cell_size, num_cells, cells, &graph));
  PetscCall(EqmOrderCuthillMcKee(&graph, new_number));
  mesh->num_blocks = EqmNumBlocks(mesh->cell_size, mesh->num_owned);
  PetscCall(PetscMalloc1(mesh->num_blocks + 1, &mesh->block_vertex));
  if (mesh->cell_size == 3) {
    PetscCall(EqmCutBlocks(mesh->num_owned, mesh->num_blocks, mesh->block_vertex));
  } else {
    PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_PARTITION));
    PetscCall(EqmOrderBlocks(&graph, mesh->num_blocks, new_number, mesh->block_vertex));
    PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_PARTITION));
  }
  PetscCall(EqmGraphReset(&graph));
  PetscFunctionReturn(0);
}

/* Number the vertices: owned ones for short ways through memory, ghosts by their global numbers. Rewrites `cells`. */
static PetscErrorCode NumberVertices(EqmMesh mesh, EqmSoup soup, PetscInt *owned, PetscInt num_ghosts, PetscInt *ghosts,
                                     PetscInt num_cells, PetscInt *cells)
{
  PetscInt *new_number, *ghost_global, *ghost_place;
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(mesh->num_owned, &new_number, num_ghosts, &ghost_global, num_ghosts, &ghost_place));
  PetscCall(OrderOwned(mesh, num_cells, cells, new_number));
  PetscCall(PetscMalloc1(mesh->num_owned, &mesh->vertex_input));
  for (PetscInt i = 0; i < mesh->num_owned; i++) mesh->vertex_input[new_number[i]] = owned[i];
  PetscCallMPI(MPI_Exscan(&mesh->num_owned, &mesh->vertex_start, 1, MPIU_INT, MPI_SUM, mesh->comm));
  if (mesh->rank == 0) mesh->vertex_start = 0;
  PetscCall(MPIU_Allreduce(&mesh->num_owned, &mesh->num_vertices, 1, MPIU_INT, MPI_SUM, mesh->comm));

  PetscCall(NumberGhosts(mesh, soup, num_ghosts, ghosts, ghost_global));
  for (PetscInt g = 0; g < num_ghosts; g++) ghost_place[g] = g;
  PetscCall(PetscSortIntWithArray(num_ghosts, ghost_global, ghost_place));
  PetscCall(PetscMalloc1(mesh->num_local, &mesh->global));
  for (PetscInt i = 0; i < mesh->num_owned; i++) mesh->global[i] = mesh->vertex_start + i;
  for (PetscInt g = 0; g < num_ghosts; g++) mesh->global[mesh->num_owned + g] = ghost_global[g];
  PetscCall(PetscLayoutCreateFromSizes(mesh->comm, mesh->num_owned, PETSC_DECIDE, 1, &layout));
  PetscCall(PetscSFCreate(mesh->comm, &mesh->halo));
  PetscCall(PetscSFSetGraphLayout(mesh->halo, layout, num_ghosts, NULL, PETSC_OWN_POINTER, ghost_global));
  PetscCall(PetscSFSetUp(mesh->halo));
  PetscCall(PetscLayoutDestroy(&layout));

  for (PetscInt g = 0; g < num_ghosts; g++) ghost_global[ghost_place[g]] = g; /* from here on: new place by old place */
  for (PetscInt k = 0; k < mesh->cell_size * num_cells; k++) {
    cells[k] =
        cells[k] < mesh->num_owned ? new_number[cells[k]] : mesh->num_owned + ghost_global[cells[k] - mesh->num_owned];
  }
  PetscCall(PetscFree3(new_number, ghost_global, ghost_place));
  PetscFunctionReturn(0);
}

/* Owned cells first, each group sorted by the smallest local vertex number so that the element loops run through memory
   once. Takes the order of arrival (input cell number) as tie-breaker: the same for every number of ranks. */
static PetscErrorCode SortCells(EqmMesh mesh, const EqmStars *stars, const PetscInt *cells, PetscInt *order)
{
  const PetscInt cs = mesh->cell_size, m = stars->num_cells;
  PetscInt *key, *bucket, num_owned = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(m, &key));
  PetscCall(PetscCalloc1(2 * mesh->num_local + 1, &bucket));
  for (PetscInt c = 0; c < m; c++) {
    PetscInt smallest_local = cells[cs * c], smallest_global = mesh->global[cells[cs * c]];
    for (PetscInt a = 1; a < cs; a++) {
      smallest_local = PetscMin(smallest_local, cells[cs * c + a]);
      smallest_global = PetscMin(smallest_global, mesh->global[cells[cs * c + a]]);
    }
    const PetscBool mine =
        (PetscBool)(smallest_global >= mesh->vertex_start && smallest_global < mesh->vertex_start + mesh->num_owned);
    num_owned += mine;
    key[c] = smallest_local + (mine ? 0 : mesh->num_local);
    bucket[key[c] + 1]++;
  }
  for (PetscInt v = 0; v < 2 * mesh->num_local; v++) bucket[v + 1] += bucket[v];
  for (PetscInt c = 0; c < m; c++) order[bucket[key[c]]++] = c;
  mesh->num_local_cells = m;
  mesh->num_owned_cells = num_owned;
  PetscCall(MPIU_Allreduce(&num_owned, &mesh->num_cells, 1, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(PetscFree(key));
  PetscCall(PetscFree(bucket));
  PetscFunctionReturn(0);
}

/* `width` reals of every received cell, fetched from the slabs; NULL where the soup has none. */
static PetscErrorCode CellReals(EqmSoup soup, const EqmStars *stars, const PetscInt *order, PetscInt width,
                                const PetscReal *slab, PetscReal **reals)
{
  PetscInt *cell;

  PetscFunctionBegin;
  *reals = NULL;
  if (!slab) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(width * stars->num_cells, reals));
  PetscCall(PetscMalloc1(stars->num_cells, &cell));
  for (PetscInt c = 0; c < stars->num_cells; c++) cell[c] = stars->records[stars->width * order[c]];
  PetscCall(EqmFetchRows(soup->comm, soup->cell_end - soup->cell_start, stars->num_cells, cell, MPIU_REAL, width, slab,
                         *reals));
  PetscCall(PetscFree(cell));
  PetscFunctionReturn(0);
}

/* Fill the mesh from the stars: vertices, cells, way back to the input. */
static PetscErrorCode TakeStars(EqmMesh mesh, EqmSoup soup, const EqmStars *stars, PetscReal **density)
{
  const PetscInt cs = mesh->cell_size;
  PetscInt *owned, *ghosts, num_ghosts, *cells, *order;

  PetscFunctionBegin;
  PetscCall(CollectVertices(stars, mesh->rank, &mesh->num_owned, &owned, &num_ghosts, &ghosts));
  mesh->num_local = mesh->num_owned + num_ghosts;
  PetscCall(PetscMalloc2(cs * stars->num_cells, &cells, stars->num_cells, &order));
  PetscCall(LocalCells(stars, mesh->num_owned, owned, num_ghosts, ghosts, mesh->rank, cells));
  PetscCall(NumberVertices(mesh, soup, owned, num_ghosts, ghosts, stars->num_cells, cells));
  PetscCall(PetscFree(owned));
  PetscCall(PetscFree(ghosts));
  PetscCall(SortCells(mesh, stars, cells, order));
  PetscCall(PetscMalloc1(cs * mesh->num_local_cells, &mesh->cells));
  PetscCall(PetscMalloc1(mesh->num_local_cells, &mesh->cell_input));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt a = 0; a < cs; a++) mesh->cells[cs * c + a] = cells[cs * order[c] + a];
    mesh->cell_input[c] = stars->records[stars->width * order[c]];
  }
  PetscCall(CellReals(soup, stars, order, 1, soup->density, density));
  PetscCall(CellReals(soup, stars, order, 3, soup->edge_length, &mesh->edge_length));
  PetscCall(PetscFree2(cells, order));
  PetscFunctionReturn(0);
}

/* Turn tetrahedra over whose volume is negative: some programs number all of them that way. */
static void OrientTetrahedra(EqmMesh mesh)
{
  const PetscReal *const p = mesh->position;

  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    PetscInt *const v = mesh->cells + 4 * c, last = v[3];

    if (EqmVolume(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2], p + 3 * v[3]) >= 0.) continue;
    v[3] = v[2];
    v[2] = last;
  }
}

PetscErrorCode EqmMeshCreate(EqmSoup soup, EqmLedger ledger, EqmMesh *out)
{
  EqmMesh mesh;
  PetscInt *owner;
  PetscReal *density;
  EqmStars stars;

  PetscFunctionBegin;
  PetscCall(EqmReserveForBlas()); /* before the mesh takes the memory */
  PetscCall(PetscNew(&mesh));
  mesh->comm = soup->comm;
  mesh->ledger = ledger;
  mesh->cell_size = soup->cell_size;
  mesh->soup = soup;
  mesh->soup_vertices = soup->num_vertices;
  PetscCall(PetscStrncpy(mesh->file, soup->file, sizeof(mesh->file)));
  PetscCall(EqmSoupComputeIdentity(soup, &mesh->identity));
  PetscCallMPI(MPI_Comm_rank(soup->comm, &mesh->rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &mesh->size));
  PetscCall(PetscMalloc1(soup->vertex_end - soup->vertex_start, &owner));
  PetscCall(EqmPartitionVertices(soup, ledger, owner));
  PetscCall(EqmStarsCollect(soup, owner, &stars));
  PetscCall(PetscFree(owner));
  PetscCall(TakeStars(mesh, soup, &stars, &density));
  PetscCall(EqmStarsReset(&stars));
  PetscCall(PetscMalloc1(3 * mesh->num_local, &mesh->position));
  PetscCall(EqmMeshVerticesFromInput(mesh, soup, 3, soup->vertices, mesh->position));
  if (mesh->cell_size == 4) OrientTetrahedra(mesh);
  PetscCall(EqmMeshFindBoundary(mesh));
  PetscCall(EqmMeshMakeBlocks(mesh));
  PetscCall(EqmMeshMeasure(mesh, density));
  PetscCall(PetscFree(density));
  *out = mesh;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMeshDestroy(EqmMesh *mesh)
{
  PetscFunctionBegin;
  if (!*mesh) PetscFunctionReturn(0);
  PetscCall(PetscFree((*mesh)->global));
  PetscCall(PetscSFDestroy(&(*mesh)->halo));
  PetscCall(PetscFree((*mesh)->cells));
  PetscCall(PetscFree((*mesh)->position));
  PetscCall(PetscFree((*mesh)->weight));
  PetscCall(PetscFree((*mesh)->cell_measure));
  PetscCall(PetscFree((*mesh)->edge_length));
  PetscCall(PetscFree((*mesh)->on_boundary));
  PetscCall(PetscFree((*mesh)->boundary_facets));
  PetscCall(PetscFree((*mesh)->boundary_order));
  PetscCall(PetscFree((*mesh)->block_vertex));
  PetscCall(PetscFree((*mesh)->block_start));
  PetscCall(PetscFree((*mesh)->block_cell));
  PetscCall(PetscFree((*mesh)->vertex_input));
  PetscCall(PetscFree((*mesh)->cell_input));
  PetscCall(PetscFree(*mesh));
  PetscFunctionReturn(0);
}
