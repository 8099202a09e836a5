/* Solids that are boxes: their own faces, edges and corners are those of the cube, and the box stretched to it
   preserves volume. */
#include "start/start.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include <stdint.h>

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

/* The unit normal of the boundary triangle that is first in the file among those at right angles, nearly, to `other`;
   NULL: among all. Zero if there is none. */
static PetscErrorCode FirstNormal(EqmMesh mesh, const PetscReal *x, const PetscReal *other, PetscReal normal[3])
{
  PetscInt64 first = INT64_MAX, lowest;
  PetscReal mine[3] = {0., 0., 0.};

  PetscFunctionBegin;
  for (PetscInt f = 0; f < mesh->num_boundary_facets; f++) {
    const PetscInt *const v = mesh->boundary_facets + 3 * f;
    PetscReal u[3], w[3], cross[3], length;
    if (mesh->boundary_order[f] >= first) continue;
    for (PetscInt k = 0; k < 3; k++) {
      u[k] = x[3 * v[1] + k] - x[3 * v[0] + k];
      w[k] = x[3 * v[2] + k] - x[3 * v[0] + k];
    }
    EqmCross(u, w, cross);
    length = PetscSqrtReal(EqmDot3(cross, cross));
    if (other && PetscAbsReal(EqmDot3(cross, other)) > .5 * length) continue;
    first = mesh->boundary_order[f];
    for (PetscInt k = 0; k < 3; k++) mine[k] = cross[k] / length;
  }
  PetscCall(MPIU_Allreduce(&first, &lowest, 1, MPIU_INT64, MPI_MIN, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) mine[k] = first == lowest ? mine[k] : -PETSC_MAX_REAL;
  PetscCall(MPIU_Allreduce(mine, normal, 3, MPIU_REAL, MPIU_MAX, mesh->comm)); /* the same on all that have it */
  PetscFunctionReturn(0);
}

/* Coordinates along the axes of a box: the normals of two of its sides, and at right angles to both. */
static PetscErrorCode TurnUpright(EqmMesh mesh, PetscReal *x)
{
  PetscReal axis[9];

  PetscFunctionBegin;
  PetscCall(FirstNormal(mesh, x, NULL, axis));
  PetscCall(FirstNormal(mesh, x, axis, axis + 3));
  EqmCross(axis, axis + 3, axis + 6);
  for (PetscInt v = 0; v < mesh->num_local; v++) {
    const PetscReal p[3] = {x[3 * v], x[3 * v + 1], x[3 * v + 2]};
    for (PetscInt k = 0; k < 3; k++) x[3 * v + k] = EqmDot3(axis + 3 * k, p);
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

static PetscErrorCode Stretch(EqmMesh solid, PetscReal *x, PetscBool *is_box)
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

PetscErrorCode EqmCubeFromBox(EqmMesh solid, PetscReal *x, PetscBool *is_box)
{
  PetscFunctionBegin;
  for (int turned = 0; turned < 2; turned++) {
    PetscCall(PetscArraycpy(x, solid->position, 3 * solid->num_local));
    if (turned) PetscCall(TurnUpright(solid, x));
    PetscCall(Stretch(solid, x, is_box));
    if (*is_box) break;
  }
  PetscFunctionReturn(0);
}
