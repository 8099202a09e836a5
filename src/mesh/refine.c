/* Uniform refinement: every triangle into four, every tetrahedron into eight. */
#include "mesh/subdivide.h"
#include "mesh/soup_private.h"

/* Children by their vertices: 0 .. cs-1 the corners, then the edges in the order of EqmCellEdge. */
static const int triangle_children[4][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}, {5, 3, 4}};
static const int corner_children[4][4] = {{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}};
/* The octahedron that the corners leave, cut along one of its diagonals: between the middles of opposite edges. */
static const int inner_children[3][4][4] = {
    {{4, 9, 7, 5}, {4, 9, 8, 7}, {4, 9, 6, 8}, {4, 9, 5, 6}},
    {{5, 8, 6, 4}, {5, 8, 9, 6}, {5, 8, 7, 9}, {5, 8, 4, 7}},
    {{6, 7, 8, 4}, {6, 7, 9, 8}, {6, 7, 5, 9}, {6, 7, 4, 5}},
};

/* The shortest of the inner octahedron's diagonals: the best shapes. Diagonal d joins the middles of the edges (0, d+1)
   and its opposite. */
static int ShortestDiagonal(const EqmVicinity *vicinity, PetscInt cell)
{
  static const int opposite[3][2] = {{2, 3}, {1, 3}, {1, 2}};
  const PetscInt *const corner = vicinity->cells + 4 * cell;
  PetscReal least = PETSC_MAX_REAL;
  int best = 0;

  for (int d = 0; d < 3; d++) {
    PetscReal square = 0.0;

    for (int k = 0; k < 3; k++) {
      const PetscReal difference = vicinity->position[3 * corner[0] + k] + vicinity->position[3 * corner[d + 1] + k] -
                                   vicinity->position[3 * corner[opposite[d][0]] + k] -
                                   vicinity->position[3 * corner[opposite[d][1]] + k];

      square += difference * difference;
    }
    /* a margin, so that rounding does not choose between equal diagonals */
    if (square < least * (1.0 - 1e-9)) {
      least = square;
      best = d;
    }
  }
  return best;
}

static PetscErrorCode AddChildren(const EqmVicinity *vicinity, PetscInt cell, const PetscInt vertex[],
                                  EqmCellList *list)
{
  const PetscInt cs = vicinity->cell_size, parent = vicinity->cell_input[cell];
  const int diagonal = cs == 4 ? ShortestDiagonal(vicinity, cell) : 0;

  PetscFunctionBegin;
  for (int child = 0; child < (cs == 3 ? 4 : 8); child++) {
    const int *const pattern = cs == 3     ? triangle_children[child]
                               : child < 4 ? corner_children[child]
                                           : inner_children[diagonal][child - 4];
    PetscInt corner[4];

    for (PetscInt a = 0; a < cs; a++) corner[a] = vertex[pattern[a]];
    PetscCall(EqmCellListAdd(list, parent, corner));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode RejectUnusable(EqmSoup soup)
{
  PetscInt unusable = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < soup->cell_end - soup->cell_start; c++) {
    unusable += EqmSoupCellUse(soup, soup->cells + soup->cell_size * c) != EQM_CELL_USABLE;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &unusable, 1, MPIU_INT, MPI_SUM, soup->comm));
  if (unusable) {
    EqmFail(soup->comm, EQM_ERR_MESH,
            "%s: %" PetscInt_FMT
            " cells name a vertex twice or one that does not exist, and cannot be refined; look with "
            "equimap check, mend with -repair",
            soup->file, unusable);
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode RefineOnce(EqmSoup *soup)
{
  const PetscInt cs = (*soup)->cell_size, num_kept = (*soup)->num_vertices;
  const int num_edges = EqmCellNumEdges(cs);
  EqmVicinity vicinity;
  EqmVertexGroup groups[2] = {
      {.num_local = (*soup)->vertex_end - (*soup)->vertex_start, .position = (*soup)->vertices}};
  EqmCellList list = {.cell_size = cs};
  PetscInt *edge_vertex, *parent;

  PetscFunctionBegin;
  PetscCall(EqmVicinityCreate(*soup, &vicinity));
  PetscCall(PetscMalloc1(num_edges * vicinity.num_cells, &edge_vertex));
  PetscCall(EqmVertexGroupPlace((*soup)->comm, &groups[0]));
  PetscCall(EqmEdgesNumber(&vicinity, NULL, &groups[1], edge_vertex));
  for (PetscInt c = 0; c < vicinity.num_cells; c++) {
    PetscInt vertex[4 + EQM_MAX_CELL_EDGES];

    if (EqmVicinityCellOwnerVertex(&vicinity, c) >= vicinity.num_owned) continue;
    for (PetscInt a = 0; a < cs; a++) vertex[a] = vicinity.input[vicinity.cells[cs * c + a]];
    for (int e = 0; e < num_edges; e++) vertex[cs + e] = num_kept + edge_vertex[num_edges * c + e];
    PetscCall(AddChildren(&vicinity, c, vertex, &list));
  }
  PetscCall(PetscFree(edge_vertex));
  PetscCall(EqmVicinityReset(&vicinity));
  PetscCall(EqmSoupAssemble(soup, 2, groups, &list, &parent));
  PetscCall(PetscFree(groups[1].position));
  PetscCall(PetscFree(parent));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupRefine(EqmSoup *soup, PetscInt times)
{
  const PetscInt children = (*soup)->cell_size == 3 ? 4 : 8;

  PetscFunctionBegin;
  if (times > 0) PetscCall(RejectUnusable(*soup));
  for (PetscInt t = 0; t < times; t++) {
    if ((*soup)->num_cells > PETSC_MAX_INT / (children * 4)) {
      EqmFail((*soup)->comm, EQM_ERR_USAGE,
              "refining %" PetscInt_FMT
              " cells once more makes too many to count; refine less often, or use a PETSc with "
              "64-bit indices",
              (*soup)->num_cells);
    }
    PetscCall(RefineOnce(soup));
  }
  PetscFunctionReturn(0);
}
