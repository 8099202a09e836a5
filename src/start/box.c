/* Solids that are boxes: their own faces, edges and corners are those of the cube, and the box stretched to it
   preserves volume. */
#include "start/start.h"
#include "mesh/mesh_private.h"

/* How far off a side of the box, in its width, a vertex may be. */
static const PetscReal tolerance = 1e-9;

/* Least and, in the second half, minus the largest coordinates of the vertices. */
static PetscErrorCode FindBox(EqmMesh mesh, const PetscReal *x, PetscReal low[3], PetscReal width[3])
{
  PetscReal box[6];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) box[k] = PETSC_MAX_REAL;
  for (PetscInt k = 0; k < 3 * mesh->num_owned; k++) {
    box[k % 3] = PetscMin(box[k % 3], x[k]);
    box[3 + k % 3] = PetscMin(box[3 + k % 3], -x[k]);
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, box, 6, MPIU_REAL, MPIU_MIN, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) {
    low[k] = box[k];
    width[k] = -box[3 + k] - box[k];
  }
  PetscFunctionReturn(0);
}

/* Does every boundary triangle lie in a side of the unit cube? */
static PetscErrorCode CheckFacets(EqmMesh mesh, const PetscReal *x, PetscBool *is_box)
{
  PetscInt fine = 1;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscBool in_side = PETSC_FALSE;
    for (PetscInt k = 0; k < 3; k++) {
      for (PetscInt side = 0; side < 2; side++)
        in_side =
            (PetscBool)(in_side || (x[3 * v[0] + k] == side && x[3 * v[1] + k] == side && x[3 * v[2] + k] == side));
    }
    fine &= in_side;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, &fine, 1, MPIU_INT, MPI_MIN, mesh->comm));
  *is_box = (PetscBool)(fine == 1);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCubeFromBox(EqmMesh solid, PetscReal *x, PetscBool *is_box)
{
  PetscReal low[3], width[3];

  PetscFunctionBegin;
  PetscCall(FindBox(solid, x, low, width));
  for (PetscInt k = 0; k < 3 * solid->num_local; k++) {
    x[k] = (x[k] - low[k % 3]) / width[k % 3];
    for (PetscInt side = 0; side < 2 && solid->on_boundary[k / 3]; side++) {
      if (PetscAbsReal(x[k] - side) <= tolerance) x[k] = side;
    }
  }
  PetscCall(CheckFacets(solid, x, is_box));
  PetscFunctionReturn(0);
}
