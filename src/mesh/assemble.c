/* A new soup from an old one, added vertices and children of cells. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"
#include "base/exchange.h"
#include "base/rows.h"

/* Append a cell; the list starts out as {.cell_size = ..}. Not collective. */
PetscErrorCode EqmCellListAdd(EqmCellList *list, PetscInt parent, const PetscInt *vertices)
{
  const PetscInt width = 1 + list->cell_size;
  PetscInt *record;

  PetscFunctionBegin;
  if (list->count == list->capacity) {
    list->capacity = PetscMax(1024, 2 * list->capacity);
    PetscCall(PetscRealloc(width * list->capacity * sizeof(PetscInt), &list->records));
  }
  record = list->records + width * list->count++;
  record[0] = parent;
  for (PetscInt a = 0; a < list->cell_size; a++) record[1 + a] = vertices[a];
  PetscFunctionReturn(0);
}

/* Where the vertices low .. high - 1 of a group are: who holds them, and at which of its places, `offset` vertices of
   other groups coming before. */
static PetscErrorCode FindHolders(MPI_Comm comm, const EqmVertexGroup *group, PetscInt offset, PetscInt low,
                                  PetscInt high, PetscSFNode *node)
{
  PetscLayout layout;
  PetscInt *offsets;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(comm, group->num_local, group->num_global, 1, &layout));
  PetscCall(PetscMalloc1(layout->size, &offsets));
  PetscCallMPI(MPI_Allgather(&offset, 1, MPIU_INT, offsets, 1, MPIU_INT, comm));
  for (PetscInt v = low; v < high; v++) {
    PetscSFNode *const place = &node[v - low];
    PetscMPIInt owner;

    PetscCall(PetscLayoutFindOwnerIndex(layout, v, &owner, &place->index));
    place->rank = owner;
    place->index += offsets[owner];
  }
  PetscCall(PetscFree(offsets));
  PetscCall(PetscLayoutDestroy(&layout));
  PetscFunctionReturn(0);
}

/* Positions of the groups' vertices, one group after the other, dealt out in even slabs. */
static PetscErrorCode DealVertices(MPI_Comm comm, PetscInt num_groups, const EqmVertexGroup *groups,
                                   PetscInt *num_local, PetscReal **position)
{
  PetscInt num_global = 0, num_roots = 0, start, end, first = 0, offset = 0;
  PetscReal *held;
  PetscSFNode *node;
  PetscSF sf;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < num_groups; g++) {
    num_global += groups[g].num_global;
    num_roots += groups[g].num_local;
  }
  *num_local = PETSC_DECIDE;
  PetscCall(PetscSplitOwnership(comm, num_local, &num_global));
  PetscCallMPI(MPI_Scan(num_local, &end, 1, MPIU_INT, MPI_SUM, comm));
  start = end - *num_local;
  PetscCall(PetscMalloc1(3 * num_roots, &held));
  PetscCall(PetscMalloc1(*num_local, &node));
  for (PetscInt g = 0; g < num_groups; g++) {
    const PetscInt low = PetscMax(first, start), high = PetscMin(first + groups[g].num_global, end);
    PetscCall(FindHolders(comm, &groups[g], offset, low - first, high - first, node + (low - start)));
    PetscCall(PetscArraycpy(held + 3 * offset, groups[g].position, 3 * groups[g].num_local));
    first += groups[g].num_global;
    offset += groups[g].num_local;
  }
  PetscCall(PetscSFCreate(comm, &sf));
  PetscCall(PetscSFSetGraph(sf, num_roots, *num_local, NULL, PETSC_OWN_POINTER, node, PETSC_OWN_POINTER));
  PetscCall(PetscMalloc1(3 * *num_local, position));
  PetscCall(EqmRowsToLeaves(sf, 3, held, *position));
  PetscCall(PetscSFDestroy(&sf));
  PetscCall(PetscFree(held));
  PetscFunctionReturn(0);
}

/* The place of a parent in the slab; behind it for none. */
static PetscInt PlaceOfParent(EqmSoup soup, PetscInt parent)
{
  return parent < 0 ? soup->cell_end - soup->cell_start : parent - soup->cell_start;
}

/* Bring the new cells to the ranks that held their parents, in the order of the parents; those without a parent, in the
   order of the ranks that made them, to the end. */
static PetscErrorCode DealCells(EqmSoup soup, EqmCellList *list, PetscInt *num_cells, PetscInt **cells,
                                PetscInt **parent)
{
  const PetscInt cs = list->cell_size, width = 1 + cs, num_parents = soup->cell_end - soup->cell_start;
  PetscInt *received, *start;
  PetscMPIInt *destination;
  PetscLayout layout;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, num_parents, soup->num_cells, 1, &layout));
  PetscCall(PetscMalloc1(list->count, &destination));
  for (PetscInt k = 0; k < list->count; k++) {
    destination[k] = layout->size - 1;
    if (list->records[width * k] >= 0)
      PetscCall(PetscLayoutFindOwner(layout, list->records[width * k], &destination[k]));
  }
  PetscCall(PetscLayoutDestroy(&layout));
  PetscCall(EqmExchange(soup->comm, list->count, width, destination, list->records, num_cells, &received));
  PetscCall(PetscFree(destination));
  PetscCall(PetscFree(list->records));
  PetscCall(PetscCalloc1(num_parents + 2, &start));
  for (PetscInt k = 0; k < *num_cells; k++) start[PlaceOfParent(soup, received[width * k]) + 1]++;
  for (PetscInt p = 0; p <= num_parents; p++) start[p + 1] += start[p];
  PetscCall(PetscMalloc1(cs * *num_cells, cells));
  PetscCall(PetscMalloc1(*num_cells, parent));
  for (PetscInt k = 0; k < *num_cells; k++) {
    const PetscInt place = start[PlaceOfParent(soup, received[width * k])]++;

    (*parent)[place] = received[width * k];
    for (PetscInt a = 0; a < cs; a++) (*cells)[cs * place + a] = received[width * k + 1 + a];
  }
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(received));
  PetscFunctionReturn(0);
}

/* Replace a soup by one with the vertices of the groups (the old ones are group 0) and the cells of the list, which is
   used up; children stand where their parents stood and inherit their density; cells without a parent (-1) come last
   and have the density 1. `parent` (PetscFree it) has the old input number per cell of the new slab. Collective. */
PetscErrorCode EqmSoupAssemble(EqmSoup *soup, PetscInt num_groups, const EqmVertexGroup *groups, EqmCellList *list,
                               PetscInt **parent)
{
  PetscInt num_vertices, num_cells, *cells;
  PetscReal *vertices, *density = NULL;
  EqmSoup made;

  PetscFunctionBegin;
  PetscCall(DealVertices((*soup)->comm, num_groups, groups, &num_vertices, &vertices));
  PetscCall(DealCells(*soup, list, &num_cells, &cells, parent));
  if ((*soup)->density) {
    PetscCall(PetscMalloc1(num_cells + 1, &density)); /* never NULL: that would say that there is none */
    for (PetscInt c = 0; c < num_cells; c++) {
      density[c] = (*parent)[c] < 0 ? 1. : (*soup)->density[PlaceOfParent(*soup, (*parent)[c])];
    }
  }
  PetscCall(EqmSoupCreateFromSlabs((*soup)->comm, (*soup)->cell_size, num_vertices, vertices, num_cells, cells,
                                   (*soup)->file, &made));
  made->density = density;
  PetscCall(EqmSoupDestroy(soup));
  *soup = made;
  PetscFunctionReturn(0);
}
