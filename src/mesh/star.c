/* Bring to every rank the cells around the vertices it owns. */
#include "mesh/build.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/rows.h"

/* Is a cell of the soup (its `cell_size` input vertex numbers) valid? Not collective. */
EqmCellUse EqmSoupCellUse(EqmSoup soup, const PetscInt *cell)
{
  EqmCellUse use = EQM_CELL_USABLE;

  for (PetscInt a = 0; a < soup->cell_size; a++) {
    if (cell[a] < 0 || cell[a] >= soup->num_vertices) return EQM_CELL_BAD_INDEX;
    for (PetscInt b = 0; b < a; b++) {
      if (cell[a] == cell[b]) use = EQM_CELL_REPEATED_VERTEX;
    }
  }
  return use;
}

/* A star forest whose roots are the soup's slabs of vertices and whose leaves are the given input vertex numbers.
   Collective. */
PetscErrorCode EqmSoupSlabSF(EqmSoup soup, PetscInt num_leaves, const PetscInt *vertices, PetscSF *sf)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsCreateSF(soup->comm, soup->vertex_end - soup->vertex_start, num_leaves, vertices, sf));
  PetscFunctionReturn(0);
}

/* Owners of the vertices of this slab's cells, fetched from the slabs that hold the vertices. Collective. */
static PetscErrorCode OwnersOfCellVertices(EqmSoup soup, const PetscInt *owner_of_slab, PetscInt *owner)
{
  const PetscInt num_entries = soup->cell_size * (soup->cell_end - soup->cell_start);
  PetscInt *vertex;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_entries, &vertex)); /* a number that does not exist has no owner: fetch any instead */
  for (PetscInt k = 0; k < num_entries; k++) {
    vertex[k] = soup->cells[k] >= 0 && soup->cells[k] < soup->num_vertices ? soup->cells[k] : 0;
  }
  PetscCall(EqmFetchRows(soup->comm, soup->vertex_end - soup->vertex_start, num_entries, vertex, MPIU_INT, 1,
                         owner_of_slab, owner));
  PetscCall(PetscFree(vertex));
  PetscFunctionReturn(0);
}

/* One record per usable cell of the slab and owner among its vertices; with `records` NULL they are only counted. */
static PetscInt PackCells(EqmSoup soup, const PetscInt *owner, PetscInt *records, PetscMPIInt *destination)
{
  const PetscInt cs = soup->cell_size, width = 1 + 2 * cs;
  PetscInt count = 0;

  for (PetscInt c = 0; c < soup->cell_end - soup->cell_start; c++) {
    if (EqmSoupCellUse(soup, soup->cells + cs * c) != EQM_CELL_USABLE) continue;
    for (PetscInt a = 0; a < cs; a++) {
      PetscBool seen = PETSC_FALSE;
      for (PetscInt b = 0; b < a; b++) seen = (PetscBool)(seen || owner[cs * c + b] == owner[cs * c + a]);
      if (seen) continue;
      if (records) {
        records[width * count] = soup->cell_start + c;
        for (PetscInt b = 0; b < cs; b++) {
          records[width * count + 1 + b] = soup->cells[cs * c + b];
          records[width * count + 1 + cs + b] = owner[cs * c + b];
        }
        destination[count] = (PetscMPIInt)owner[cs * c + a];
      }
      count++;
    }
  }
  return count;
}

/* Send every usable cell to each owner among its vertices. `owner_of_slab` gives the owning rank of each vertex of the
   slab; NULL: the rank that has the slab. Collective. */
PetscErrorCode EqmStarsCollect(EqmSoup soup, const PetscInt *owner_of_slab, EqmStars *stars)
{
  const PetscInt cs = soup->cell_size, num_cells = soup->cell_end - soup->cell_start, width = 1 + 2 * cs;
  const PetscInt num_vertices = soup->vertex_end - soup->vertex_start;
  PetscInt *owner, *slab_owner, *records, count;
  PetscMPIInt *destination, rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &rank));
  PetscCall(PetscMalloc2(cs * num_cells, &owner, num_vertices, &slab_owner));
  for (PetscInt v = 0; v < num_vertices; v++) slab_owner[v] = owner_of_slab ? owner_of_slab[v] : rank;
  PetscCall(OwnersOfCellVertices(soup, slab_owner, owner));
  count = PackCells(soup, owner, NULL, NULL);
  PetscCall(PetscMalloc2(width * count, &records, count, &destination));
  (void)PackCells(soup, owner, records, destination);
  PetscCall(PetscFree2(owner, slab_owner));
  stars->cell_size = cs;
  stars->width = width;
  PetscCall(EqmExchange(soup->comm, count, width, destination, records, &stars->num_cells, &stars->records));
  PetscCall(PetscFree2(records, destination));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmStarsReset(EqmStars *stars)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(stars->records));
  stars->num_cells = 0;
  PetscFunctionReturn(0);
}
