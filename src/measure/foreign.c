#include "measure/foreign.h"
#include "mesh/mesh_private.h"
#include "store/map_private.h"

/* Are the images of all vertices their own positions, but for a millionth of the mesh's size? Collective. */
static PetscErrorCode RepeatsMesh(EqmMesh mesh, const PetscReal *x, PetscBool *repeats)
{
  PetscReal bound[4] = {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, 0.}, high[4] = {0.};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3; k++) high[k] = -PETSC_MAX_REAL;
  for (PetscInt i = 0; i < 3 * mesh->num_owned; i++) {
    bound[i % 3] = PetscMin(bound[i % 3], mesh->position[i]);
    high[i % 3] = PetscMax(high[i % 3], mesh->position[i]);
    high[3] = PetscMax(high[3], PetscAbsReal(x[i] - mesh->position[i]));
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, bound, 3, MPIU_REAL, MPIU_MIN, mesh->comm));
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, high, 4, MPIU_REAL, MPIU_MAX, mesh->comm));
  for (PetscInt k = 0; k < 3; k++) bound[3] = PetscMax(bound[3], high[k] - bound[k]);
  *repeats = (PetscBool)(high[3] <= 1e-6 * bound[3]);
  PetscFunctionReturn(0);
}

/* Images that are no numbers are no map. */
static PetscErrorCode CheckFinite(EqmMesh mesh, PetscInt dim, const PetscReal *x)
{
  PetscInt first = PETSC_MAX_INT, lowest;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < dim * mesh->num_owned; i++) {
    if (PetscIsInfOrNanReal(x[i])) first = PetscMin(first, mesh->vertex_input[i / dim]);
  }
  PetscCall(MPIU_Allreduce(&first, &lowest, 1, MPIU_INT, MPI_MIN, mesh->comm));
  if (lowest < PETSC_MAX_INT)
    EqmFail(mesh->comm, EQM_ERR_MESH,
            "the image of vertex %" PetscInt_FMT " is not finite: give the map a place for every vertex of a cell",
            lowest);
  PetscFunctionReturn(0);
}

/* Nor is what has no area or volume, or one that a double cannot hold. */
static PetscErrorCode CheckExtent(EqmMesh mesh, const EqmImagePlacement *placement)
{
  PetscFunctionBegin;
  if (placement->size > 0. && !PetscIsInfOrNanReal(placement->size)) PetscFunctionReturn(0);
  EqmFail(mesh->comm, EQM_ERR_MESH,
          "the image has no %s, or one beyond a double's range: it is no map, or wants another unit of length",
          mesh->cell_size == 3 ? "area" : "volume");
}

/* EqmMapMeasureForeign - compute distortion, ratios and folds of a map that another program made, wherever its image
   lies and however large it is.

   Collective. x - the images of the mesh's local vertices, ghosts included; moved and scaled to the unit domain that
   the image fills, or to area or volume one: so the energy does not depend on the units of the file, and equals that of
   our own maps. placement - what the image was recognised as. repeats - the image is the mesh itself, which is neither
   flat nor a sphere nor a ball: nothing is measured then. The triangles of an image that is neither of the plane nor on
   a sphere have no side: none counts as a fold. Errors: EQM_ERR_MESH (images that are not finite, no area). */
PetscErrorCode EqmMapMeasureForeign(EqmMap map, EqmMesh mesh, PetscReal *x, EqmImagePlacement *placement,
                                    PetscBool *repeats)
{
  PetscFunctionBegin;
  *repeats = PETSC_FALSE;
  PetscCall(CheckFinite(mesh, map->dim, x));
  PetscCall(EqmImageRecognise(mesh, map->dim, x, placement));
  if (placement->shape == EQM_FILLS_SPACE || placement->shape == EQM_FILLS_SOLID)
    PetscCall(RepeatsMesh(mesh, x, repeats));
  if (*repeats) PetscFunctionReturn(0);
  PetscCall(CheckExtent(mesh, placement));
  map->in_space = (PetscBool)(placement->shape == EQM_FILLS_SPACE);
  EqmImageToUnit(mesh, map->dim, placement, x);
  PetscCall(EqmMapMeasure(map, mesh, x));
  PetscFunctionReturn(0);
}
