/* Collect the cells around each rank's slab of vertices. */
#include "mesh/diagnose.h"
#include "mesh/soup_private.h"
#include "mesh/build.h"
#include "base/exchange.h"
#include "base/rows.h"
#include "geometry/simplex.h"

/* The usable cells around the vertices of this rank's slab, in input order. */
static PetscErrorCode CollectCells(EqmSoup soup, EqmVicinity *vicinity)
{
  const PetscInt cs = soup->cell_size;
  EqmStars stars;

  PetscFunctionBegin;
  PetscCall(EqmStarsCollect(soup, NULL, &stars));
  vicinity->num_cells = stars.num_cells;
  PetscCall(PetscMalloc1(vicinity->num_cells, &vicinity->cell_input));
  PetscCall(PetscMalloc1(cs * vicinity->num_cells, &vicinity->cells));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    vicinity->cell_input[c] = stars.records[stars.width * c];
    for (PetscInt a = 0; a < cs; a++) vicinity->cells[cs * c + a] = stars.records[stars.width * c + 1 + a];
  }
  PetscCall(EqmStarsReset(&stars));
  PetscFunctionReturn(0);
}

/* From input to local vertex numbers. */
static PetscErrorCode NumberVertices(EqmVicinity *vicinity)
{
  const PetscInt num_entries = vicinity->cell_size * vicinity->num_cells, start = vicinity->layout->rstart;
  const PetscInt end = vicinity->layout->rend;
  PetscInt num_ghosts = 0, *ghost, *place;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < num_entries; k++) num_ghosts += vicinity->cells[k] < start || vicinity->cells[k] >= end;
  PetscCall(PetscMalloc1(num_ghosts, &ghost));
  num_ghosts = 0;
  for (PetscInt k = 0; k < num_entries; k++) {
    if (vicinity->cells[k] < start || vicinity->cells[k] >= end) ghost[num_ghosts++] = vicinity->cells[k];
  }
  PetscCall(PetscSortRemoveDupsInt(&num_ghosts, ghost));
  vicinity->num_owned = end - start;
  vicinity->num_local = vicinity->num_owned + num_ghosts;
  PetscCall(PetscMalloc1(vicinity->num_local, &vicinity->input));
  PetscCall(PetscMalloc1(num_ghosts, &place));
  for (PetscInt v = 0; v < vicinity->num_owned; v++) vicinity->input[v] = start + v;
  for (PetscInt g = 0; g < num_ghosts; g++) {
    vicinity->input[vicinity->num_owned + g] = ghost[g];
    place[g] = vicinity->num_owned + g;
  }
  for (PetscInt k = 0; k < num_entries; k++) {
    PetscInt *const vertex = &vicinity->cells[k];

    if (*vertex >= start && *vertex < end) {
      *vertex -= start;
    } else {
      PetscInt found;

      PetscCall(PetscFindInt(*vertex, num_ghosts, ghost, &found));
      *vertex = vicinity->num_owned + found;
    }
  }
  PetscCall(PetscSFCreate(vicinity->comm, &vicinity->ghosts));
  PetscCall(PetscSFSetGraphLayout(vicinity->ghosts, vicinity->layout, num_ghosts, place, PETSC_COPY_VALUES, ghost));
  PetscCall(PetscFree(place));
  PetscCall(PetscFree(ghost));
  PetscFunctionReturn(0);
}

static PetscErrorCode CollectPositions(EqmSoup soup, EqmVicinity *vicinity)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * vicinity->num_local, &vicinity->position));
  PetscCall(PetscArraycpy(vicinity->position, soup->vertices, 3 * vicinity->num_owned));
  PetscCall(EqmRowsToLeaves(vicinity->ghosts, 3, vicinity->position, vicinity->position));
  PetscFunctionReturn(0);
}

static PetscErrorCode FindSides(EqmVicinity *vicinity)
{
  const PetscReal *const p = vicinity->position;

  PetscFunctionBegin;
  if (vicinity->cell_size != 4) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(vicinity->num_cells, &vicinity->side));
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    const PetscInt *const v = vicinity->cells + 4 * c;
    const PetscReal volume = EqmVolume(p + 3 * v[0], p + 3 * v[1], p + 3 * v[2], p + 3 * v[3]);

    vicinity->side[c] = (signed char)((volume > 0.0) - (volume < 0.0));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode MakeStars(EqmVicinity *vicinity)
{
  const PetscInt cs = vicinity->cell_size;
  PetscInt *const start = vicinity->star_start;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(start, vicinity->num_owned + 1));
  for (PetscInt k = 0; k < cs * vicinity->num_cells; k++) {
    if (vicinity->cells[k] < vicinity->num_owned) start[vicinity->cells[k] + 1]++;
  }
  for (PetscInt v = 0; v < vicinity->num_owned; v++) start[v + 1] += start[v];
  if (!vicinity->star) PetscCall(PetscMalloc1(start[vicinity->num_owned], &vicinity->star));
  for (PetscInt k = 0; k < cs * vicinity->num_cells; k++) {
    if (vicinity->cells[k] < vicinity->num_owned) vicinity->star[start[vicinity->cells[k]]++] = k / cs;
  }
  for (PetscInt v = vicinity->num_owned; v > 0; v--) start[v] = start[v - 1];
  start[0] = 0;
  PetscFunctionReturn(0);
}

/* The cells and vertices of a vicinity alone: without positions, sides and stars. Free with EqmVicinityReset.
   Collective. */
PetscErrorCode EqmVicinityCreateCells(EqmSoup soup, EqmVicinity *vicinity)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(vicinity, sizeof(*vicinity)));
  vicinity->comm = soup->comm;
  vicinity->cell_size = soup->cell_size;
  PetscCallMPI(MPI_Comm_rank(soup->comm, &vicinity->rank));
  PetscCallMPI(MPI_Comm_size(soup->comm, &vicinity->size));
  PetscCall(PetscLayoutCreateFromSizes(soup->comm, soup->vertex_end - soup->vertex_start, soup->num_vertices, 1,
                                       &vicinity->layout));
  PetscCall(CollectCells(soup, vicinity));
  PetscCall(NumberVertices(vicinity));
  PetscFunctionReturn(0);
}

/* Build the view of a soup: every rank gets all usable cells around the vertices of its slab, and the positions of all
   their vertices. Free with EqmVicinityReset. Collective. */
PetscErrorCode EqmVicinityCreate(EqmSoup soup, EqmVicinity *vicinity)
{
  PetscFunctionBegin;
  PetscCall(EqmVicinityCreateCells(soup, vicinity));
  PetscCall(CollectPositions(soup, vicinity));
  PetscCall(FindSides(vicinity));
  PetscCall(PetscMalloc1(vicinity->num_owned + 1, &vicinity->star_start));
  PetscCall(MakeStars(vicinity));
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmVicinityReset(EqmVicinity *vicinity)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(vicinity->input));
  PetscCall(PetscFree(vicinity->position));
  PetscCall(PetscFree(vicinity->cells));
  PetscCall(PetscFree(vicinity->cell_input));
  PetscCall(PetscFree(vicinity->side));
  PetscCall(PetscFree(vicinity->star_start));
  PetscCall(PetscFree(vicinity->star));
  PetscCall(PetscSFDestroy(&vicinity->ghosts));
  PetscCall(PetscLayoutDestroy(&vicinity->layout));
  PetscFunctionReturn(0);
}

/* The vertex of a cell with the lowest input number, as a local number: the cell is this rank's if that is owned here.
   Not collective. */
PetscInt EqmVicinityCellOwnerVertex(const EqmVicinity *vicinity, PetscInt cell)
{
  const PetscInt *const vertex = vicinity->cells + vicinity->cell_size * cell;
  PetscInt lowest = vertex[0];

  for (PetscInt a = 1; a < vicinity->cell_size; a++) {
    if (vicinity->input[vertex[a]] < vicinity->input[lowest]) lowest = vertex[a];
  }
  return lowest;
}

/* Forget the cells that have an earlier twin; `first` is EqmVicinityFindDuplicates's and shrinks alike. Not collective.
 */
PetscErrorCode EqmVicinityDropDuplicates(EqmVicinity *vicinity, PetscInt *first)
{
  const PetscInt cs = vicinity->cell_size;
  PetscInt kept = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < vicinity->num_cells; c++) {
    if (first[c] != c) continue;
    vicinity->cell_input[kept] = vicinity->cell_input[c];
    if (cs == 4) vicinity->side[kept] = vicinity->side[c];
    for (PetscInt a = 0; a < cs; a++) vicinity->cells[cs * kept + a] = vicinity->cells[cs * c + a];
    kept++;
  }
  if (kept != vicinity->num_cells) {
    vicinity->num_cells = kept;
    for (PetscInt c = 0; c < kept; c++) first[c] = c;
    PetscCall(MakeStars(vicinity));
  }
  PetscFunctionReturn(0);
}

/* A star forest over cells: roots are the cells that a rank owns, leaves the copies of them on other ranks, both at
   their local numbers. Collective. */
PetscErrorCode EqmVicinityCellSF(const EqmVicinity *vicinity, PetscSF *sf)
{
  const PetscInt cs = vicinity->cell_size;
  PetscInt count = 0, *records, *received, num_leaves, *leaf;
  PetscMPIInt *destination;
  PetscSFNode *root;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(3 * cs * vicinity->num_cells, &records, cs * vicinity->num_cells, &destination));
  for (PetscInt c = 0; vicinity->size > 1 && c < vicinity->num_cells; c++) {
    if (EqmVicinityCellOwnerVertex(vicinity, c) >= vicinity->num_owned) continue;
    for (PetscInt a = 0; a < cs; a++) {
      const PetscInt vertex = vicinity->cells[cs * c + a];
      PetscBool seen = PETSC_FALSE;
      PetscMPIInt owner;

      if (vertex < vicinity->num_owned) continue;
      PetscCall(PetscLayoutFindOwner(vicinity->layout, vicinity->input[vertex], &owner));
      for (PetscInt k = count - 1; k >= 0 && records[3 * k] == vicinity->cell_input[c]; k--) {
        seen = (PetscBool)(seen || destination[k] == owner);
      }
      if (seen) continue;
      records[3 * count] = vicinity->cell_input[c];
      records[3 * count + 1] = vicinity->rank;
      records[3 * count + 2] = c;
      destination[count++] = owner;
    }
  }
  PetscCall(EqmExchange(vicinity->comm, count, 3, destination, records, &num_leaves, &received));
  PetscCall(PetscMalloc1(num_leaves, &leaf));
  PetscCall(PetscMalloc1(num_leaves, &root));
  for (PetscInt k = 0; k < num_leaves; k++) {
    PetscCall(PetscFindInt(received[3 * k], vicinity->num_cells, vicinity->cell_input, &leaf[k]));
    root[k].rank = received[3 * k + 1];
    root[k].index = received[3 * k + 2];
  }
  PetscCall(PetscSFCreate(vicinity->comm, sf));
  PetscCall(PetscSFSetGraph(*sf, vicinity->num_cells, num_leaves, leaf, PETSC_OWN_POINTER, root, PETSC_OWN_POINTER));
  PetscCall(PetscFree(received));
  PetscCall(PetscFree2(records, destination));
  PetscFunctionReturn(0);
}
