/* One of the pieces of a mesh, taken out of it. */
#include "prepare/components.h"
#include "base/rows.h"
#include "mesh/soup_private.h"

/* The cells of a piece with their densities, and its vertices, as a soup. */
static PetscErrorCode Extract(EqmSoup from, const EqmRowsOfPieces *cell, const PetscInt *corner, PetscInt piece,
                              PetscInt num_vertices, PetscReal *vertices, EqmSoup *soup)
{
  const PetscInt cs = from->cell_size, first = cell->start[piece], num = cell->start[piece + 1] - first;
  PetscReal *density = NULL;
  PetscInt *cells;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cs * num, &cells));
  PetscCall(PetscArraycpy(cells, corner + cs * first, cs * num));
  if (from->density) PetscCall(PetscMalloc1(num + 1, &density)); /* never NULL: that would say that there is none */
  for (PetscInt c = 0; c < num && density; c++) density[c] = from->density[cell->row[first + c]];
  PetscCall(EqmSoupCreateFromSlabs(from->comm, cs, num_vertices, vertices, num, cells, from->file, soup));
  (*soup)->density = density;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmComponentsTake(const EqmComponents *components, PetscInt piece, EqmSoup *given, EqmPreparation *begun)
{
  const EqmSoup soup = components->whole.soup;
  const PetscInt first = components->vertex.start[piece], num = components->vertex.start[piece + 1] - first;
  const PetscInt first_cell = components->cell.start[piece];
  const PetscInt num_cells = components->cell.start[piece + 1] - first_cell, num_kept = components->num_kept[piece];
  PetscReal *vertices;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * num_kept, &vertices));
  PetscCall(PetscArraycpy(vertices, components->given_position + 3 * first, 3 * num_kept));
  PetscCall(
      Extract(components->given, &components->given_cell, components->given_corner, piece, num_kept, vertices, given));
  PetscCall(PetscMalloc1(3 * num, &vertices));
  for (PetscInt v = 0; v < num; v++)
    PetscCall(PetscArraycpy(vertices + 3 * v, soup->vertices + 3 * components->vertex.row[first + v], 3));
  *begun = (EqmPreparation){.is_changed = (PetscBool)(components->num_pieces > 1 || components->whole.is_changed)};
  PetscCall(Extract(soup, &components->cell, components->corner, piece, num, vertices, &begun->soup));
  PetscCall(PetscMalloc1(num_cells, &begun->parent));
  PetscCall(PetscArraycpy(begun->parent, components->parent + first_cell, num_cells));
  PetscCall(PetscMalloc1(num_kept, &begun->vertex));
  PetscCall(PetscArraycpy(begun->vertex, components->stand_in + first, num_kept));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmComponentsName(const EqmComponents *components, PetscInt piece, PetscInt count, PetscInt *number)
{
  const EqmSoup soup = components->whole.soup;
  const PetscInt first = components->vertex.start[piece], mine = components->vertex.start[piece + 1] - first;
  const PetscInt before = components->before[piece];
  PetscInt total;

  PetscFunctionBegin;
  PetscCall(MPIU_Allreduce(&mine, &total, 1, MPIU_INT, MPI_SUM, soup->comm));
  for (PetscInt k = 0; k < count; k++) {
    PetscInt name = -1;

    if (number[k] >= before && number[k] < before + mine)
      name = soup->vertex_start + components->vertex.row[first + number[k] - before];
    if (number[k] >= total) name = soup->num_vertices + number[k] - total;
    number[k] = name;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, number, (PetscMPIInt)count, MPIU_INT, MPI_MAX, soup->comm));
  PetscFunctionReturn(0);
}
