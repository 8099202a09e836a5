/* Regular meshes of the unit targets. */
#include "mesh/generate.h"
#include <string.h>

typedef struct {
  const char *target;
  const EqmLattice *lattice;
  EqmPlacement place;
  int least;                /* n */
  PetscReal cells_per_size; /* as many cells as this times a power of n, */
  int power;                /* the dimension */
  void (*plan)(PetscInt n, EqmLatticePlan *plan);
} EqmTargetMesh;

static void Keep(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  (void)plan;
  for (int k = 0; k < 3; k++) position[k] = parameter[k];
}

static void PlaceUnitCube(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  (void)plan;
  for (int k = 0; k < 3; k++) position[k] = .5 * (parameter[k] + 1.);
}

static void PlanSquare(PetscInt n, EqmLatticePlan *plan)
{
  plan->cell_size = 3;
  plan->size[0] = plan->size[1] = n;
  plan->num_vertices = n * n;
  plan->num_cells = 2 * (n - 1) * (n - 1);
}

static void PlanDisk(PetscInt n, EqmLatticePlan *plan)
{
  plan->cell_size = 3;
  plan->size[0] = n;
  plan->num_vertices = 3 * n * (n + 1) + 1;
  plan->num_cells = 6 * n * n;
}

static void PlanSphere(PetscInt n, EqmLatticePlan *plan)
{
  plan->cell_size = 3;
  plan->size[0] = n;
  plan->num_vertices = 10 * n * n + 2;
  plan->num_cells = 20 * n * n;
}

static void PlanSolid(PetscInt n, EqmLatticePlan *plan)
{
  plan->cell_size = 4;
  plan->size[0] = 2 * n;
  plan->num_vertices = (2 * n + 1) * (2 * n + 1) * (2 * n + 1);
  plan->num_cells = 48 * n * n * n;
}

static const EqmTargetMesh meshes[] = {
    {"square", &EqmLatticeRectangle, Keep, 2, 2., 2, PlanSquare},
    {"disk", &EqmLatticeHexagon, Keep, 1, 6., 2, PlanDisk},
    {"sphere", &EqmLatticeIcosahedron, Keep, 1, 20., 2, PlanSphere},
    {"ball", &EqmLatticeCube, EqmPlaceBall, 2, 48., 3, PlanSolid},
    {"cube", &EqmLatticeCube, PlaceUnitCube, 2, 48., 3, PlanSolid},
};

PetscErrorCode EqmSoupGenerateTarget(MPI_Comm comm, const char *target, PetscInt n, EqmSoup *soup)
{
  const EqmTargetMesh *mesh = NULL;
  EqmLatticePlan plan = {.regular = PETSC_TRUE};
  PetscInt most;

  PetscFunctionBegin;
  for (size_t k = 0; k < sizeof(meshes) / sizeof(meshes[0]); k++) {
    if (!strcmp(target, meshes[k].target)) mesh = &meshes[k];
  }
  PetscCheck(mesh, comm, PETSC_ERR_ARG_OUTOFRANGE, "no target %s", target);
  /* corners of cells must be countable */
  most = (PetscInt)PetscPowReal(PETSC_MAX_INT / (4. * mesh->cells_per_size), 1. / mesh->power);
  if (n < mesh->least || n > most)
    EqmFail(comm, EQM_ERR_USAGE, "-grid %" PetscInt_FMT ": for the %s give %d to %" PetscInt_FMT, n, target,
            mesh->least, most);
  mesh->plan(n, &plan);
  PetscCall(EqmSoupFromLattice(comm, mesh->lattice, &plan, mesh->place, target, soup));
  PetscFunctionReturn(0);
}
