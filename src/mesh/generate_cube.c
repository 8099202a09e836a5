/* Cubes of tetrahedra: 2 h x 2 h x 2 h small cubes, six tetrahedra each, mirrored at the middle planes so that every
   small cube's diagonal points to the centre: no edge then cuts a corner and no tetrahedron lies in the boundary;
   size[0] = 2 h. */
#include "mesh/generate.h"

static void PlanCube(PetscInt n, EqmLatticePlan *plan)
{
  const PetscInt k = PetscMax(4, 2 * (PetscInt)((PetscPowReal(n, 1.0 / 3.0) - 1.0) / 2.0 + 0.5));

  plan->cell_size = 4;
  plan->size[0] = k;
  plan->num_vertices = (k + 1) * (k + 1) * (k + 1);
  plan->num_cells = 6 * k * k * k;
}

static void ParameterCube(const EqmLatticePlan *plan, PetscInt vertex, PetscReal parameter[3])
{
  const PetscInt k = plan->size[0],
                 place[3] = {vertex % (k + 1), vertex / (k + 1) % (k + 1), vertex / (k + 1) / (k + 1)};

  for (int c = 0; c < 3; c++) {
    const PetscBool on_side = (PetscBool)(place[c] == 0 || place[c] == k);

    parameter[c] = 2.0 * (place[c] + (on_side ? 0.0 : EqmLatticeJitter(plan, vertex, c))) / k - 1.0;
  }
}

static void CellCube(const EqmLatticePlan *plan, PetscInt cell, PetscInt vertices[])
{
  static const int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const PetscInt k = plan->size[0], small = cell / 6, order = cell % 6;
  const PetscInt cube[3] = {small % k, small / k % k, small / k / k}, stride[3] = {1, k + 1, (k + 1) * (k + 1)};
  PetscBool mirrored = (PetscBool)(order >= 3);
  PetscInt place = 0;

  for (int c = 0; c < 3; c++) {
    const PetscBool far = (PetscBool)(cube[c] >= k / 2);

    place += (cube[c] + (far ? 1 : 0)) * stride[c];
    if (far) mirrored = (PetscBool)!mirrored;
  }
  vertices[0] = place;
  for (int step = 0; step < 3; step++) {
    const int c = path[order][step];

    place += cube[c] >= k / 2 ? -stride[c] : stride[c];
    vertices[step + 1] = place;
  }
  if (mirrored) {
    place = vertices[2];
    vertices[2] = vertices[3];
    vertices[3] = place;
  }
}

const EqmLattice EqmLatticeCube = {PlanCube, ParameterCube, CellCube};
