/* Test surfaces and solids of any size, the same on any number of ranks. */
#include "mesh/generate.h"

typedef struct {
  const char *name, *description;
  const EqmLattice *lattice;
  EqmPlacement place;
} EqmShape;

#define EQM_NUM_SHAPES 13

static const EqmShape shape_table[EQM_NUM_SHAPES] = {
    {"cap", "spherical cap, one boundary loop, finer towards its pole (disk)", &EqmLatticeHexagon, EqmPlaceCap},
    {"patch", "rectangle rolled on a cylinder, with four corners (disk, square)", &EqmLatticeRectangle, EqmPlacePatch},
    {"hills", "square with steep peaks and pits at random places (disk, square; hard)", &EqmLatticeRectangle,
     EqmPlaceHills},
    {"sphere", "unit sphere, subdivided icosahedron, jittered (sphere)", &EqmLatticeIcosahedron, EqmPlaceSphere},
    {"head", "closed smooth blob with random bumps (sphere)", &EqmLatticeIcosahedron, EqmPlaceHead},
    {"starfish", "closed body with five thin arms (sphere; hard)", &EqmLatticeIcosahedron, EqmPlaceStarfish},
    {"ball", "unit ball of tetrahedra (ball)", &EqmLatticeCube, EqmPlaceBall},
    {"blob", "ball of tetrahedra, stretched and bent at random (ball)", &EqmLatticeCube, EqmPlaceBlob},
    {"figure", "solid of tetrahedra with arms, legs and a head (ball; hard)", &EqmLatticeCube, EqmPlaceFigure},
    {"cube", "cube of tetrahedra (ball)", &EqmLatticeCube, EqmPlaceCube},
    {"torus", "closed surface of genus 1 (bad input: no command can map it)", &EqmLatticeTorus, EqmPlaceTorus},
    {"annulus", "flat ring with two boundary loops (bad input)", &EqmLatticeAnnulus, EqmPlaceAnnulus},
    {"moebius", "Moebius band, not orientable (bad input)", &EqmLatticeMoebius, EqmPlaceMoebius},
};

PetscErrorCode EqmGenerateShapes(const char *const **names, const char *const **descriptions, int *n)
{
  const char **name = NULL, **description = NULL;

  PetscFunctionBegin;
  if (names) PetscCall(PetscMalloc1(EQM_NUM_SHAPES, &name));
  if (descriptions) PetscCall(PetscMalloc1(EQM_NUM_SHAPES, &description));
  for (int i = 0; i < EQM_NUM_SHAPES; i++) {
    if (name) name[i] = shape_table[i].name;
    if (description) description[i] = shape_table[i].description;
  }
  if (names) *names = (const char *const *)name;
  if (descriptions) *descriptions = (const char *const *)description;
  if (n) *n = EQM_NUM_SHAPES;
  PetscFunctionReturn(0);
}

static PetscErrorCode FindShape(MPI_Comm comm, const char *name, const EqmShape **found)
{
  char list[512] = "";

  PetscFunctionBegin;
  *found = NULL;
  for (int i = 0; i < EQM_NUM_SHAPES; i++) {
    PetscBool same;

    PetscCall(PetscStrcmp(name, shape_table[i].name, &same));
    if (same) *found = &shape_table[i];
    if (i) PetscCall(PetscStrlcat(list, ", ", sizeof(list)));
    PetscCall(PetscStrlcat(list, shape_table[i].name, sizeof(list)));
  }
  if (!*found) EqmFail(comm, EQM_ERR_USAGE, "There is no shape '%s'; choose one of %s", name, list);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupFromLattice(MPI_Comm comm, const EqmLattice *lattice, const EqmLatticePlan *plan,
                                  EqmPlacement place, const char *name, EqmSoup *soup)
{
  PetscInt total_vertices = plan->num_vertices, total_cells = plan->num_cells;
  PetscInt num_vertices = PETSC_DECIDE, num_cells = PETSC_DECIDE, vertex_end, cell_end, *cells;
  PetscReal *vertices;

  PetscFunctionBegin;
  PetscCall(PetscSplitOwnership(comm, &num_vertices, &total_vertices));
  PetscCall(PetscSplitOwnership(comm, &num_cells, &total_cells));
  PetscCallMPI(MPI_Scan(&num_vertices, &vertex_end, 1, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Scan(&num_cells, &cell_end, 1, MPIU_INT, MPI_SUM, comm));
  PetscCall(PetscMalloc1(3 * num_vertices, &vertices));
  PetscCall(PetscMalloc1(plan->cell_size * num_cells, &cells));
  for (PetscInt i = 0; i < num_vertices; i++) {
    PetscReal parameter[3];

    lattice->parameter(plan, vertex_end - num_vertices + i, parameter);
    place(plan, parameter, vertices + 3 * i);
  }
  for (PetscInt i = 0; i < num_cells; i++) {
    lattice->cell(plan, cell_end - num_cells + i, cells + plan->cell_size * i);
  }
  PetscCall(EqmSoupCreateFromSlabs(comm, plan->cell_size, num_vertices, vertices, num_cells, cells, name, soup));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmSoupGenerate(MPI_Comm comm, const char *shape_name, PetscInt n, PetscInt seed, EqmSoup *soup)
{
  const PetscInt n_max = PETSC_MAX_INT / 8; /* tetrahedra: six per vertex, and headroom */
  const EqmShape *shape;
  EqmLatticePlan plan = {.seed = seed};

  PetscFunctionBegin;
  PetscCall(FindShape(comm, shape_name, &shape));
  if (n < 1 || n > n_max) {
    EqmFail(comm, EQM_ERR_USAGE, "A shape of %" PetscInt_FMT " vertices is out of range; ask for 1 to %" PetscInt_FMT,
            n, n_max);
  }
  shape->lattice->plan(n, &plan);
  PetscCall(EqmSoupFromLattice(comm, shape->lattice, &plan, shape->place, shape_name, soup));
  PetscFunctionReturn(0);
}
