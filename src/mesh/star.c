/* Bring to every rank the cells around the vertices it owns. */
#include "mesh/build.h"
#include "base/exchange.h"
#include "base/rows.h"

/* A star forest whose roots are the soup's slabs of vertices and whose leaves are the given input vertex numbers.
   Collective. */
PetscErrorCode EqmSoupSlabSF(EqmSoup soup, PetscInt num_leaves, const PetscInt *vertices, PetscSF *sf)
{
  PetscFunctionBegin;
  PetscCall(EqmRowsCreateSF(soup->comm, soup->vertex_end - soup->vertex_start, num_leaves, vertices, sf));
  PetscFunctionReturn(0);
}

/* Owners of the vertices of this slab's cells, asked from the slabs that hold the vertices. */
static PetscErrorCode OwnersOfCellVertices(EqmSoup soup, const PetscInt *owner_of_slab, PetscInt *owner)
{
  const PetscInt num_entries = soup->cell_size * (soup->cell_end - soup->cell_start);
  PetscMPIInt size;
  PetscSF sf;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(soup->comm, &size));
  if (size == 1) {
    for (PetscInt k = 0; k < num_entries; k++) owner[k] = owner_of_slab[soup->cells[k]];
    PetscFunctionReturn(0);
  }
  PetscCall(EqmSoupSlabSF(soup, num_entries, soup->cells, &sf));
  PetscCall(PetscSFBcastBegin(sf, MPIU_INT, owner_of_slab, owner, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(sf, MPIU_INT, owner_of_slab, owner, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&sf));
  PetscFunctionReturn(0);
}

/* Send every cell to each owner among its vertices. `owner_of_slab` gives the owning rank of each vertex of the slab.
   Collective. */
PetscErrorCode EqmStarsCollect(EqmSoup soup, const PetscInt *owner_of_slab, EqmStars *stars)
{
  const PetscInt cs = soup->cell_size, num_cells = soup->cell_end - soup->cell_start, width = 1 + 2 * cs;
  PetscInt *owner, *records, count = 0;
  PetscMPIInt *destination;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cs * num_cells, &owner));
  PetscCall(OwnersOfCellVertices(soup, owner_of_slab, owner));
  for (PetscInt c = 0; c < num_cells; c++) {
    for (PetscInt a = 0; a < cs; a++) {
      PetscBool seen = PETSC_FALSE;
      for (PetscInt b = 0; b < a; b++) seen = (PetscBool)(seen || owner[cs * c + b] == owner[cs * c + a]);
      if (!seen) count++;
    }
  }
  PetscCall(PetscMalloc2(width * count, &records, count, &destination));
  count = 0;
  for (PetscInt c = 0; c < num_cells; c++) {
    for (PetscInt a = 0; a < cs; a++) {
      PetscBool seen = PETSC_FALSE;
      for (PetscInt b = 0; b < a; b++) seen = (PetscBool)(seen || owner[cs * c + b] == owner[cs * c + a]);
      if (seen) continue;
      records[width * count] = soup->cell_start + c;
      for (PetscInt b = 0; b < cs; b++) {
        records[width * count + 1 + b] = soup->cells[cs * c + b];
        records[width * count + 1 + cs + b] = owner[cs * c + b];
      }
      destination[count++] = (PetscMPIInt)owner[cs * c + a];
    }
  }
  PetscCall(PetscFree(owner));
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
