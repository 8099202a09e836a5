/* The corners of maps to the square, as arc lengths along the boundary in [0, 1). `arc`: of every local vertex, -1
 * inside.
 */
#ifndef EQM_CORNERS_H
#define EQM_CORNERS_H

#include <equimap/mesh.h>

/* Arc lengths of four boundary vertices (input numbers). Errors: EQM_ERR_USAGE (not on the boundary). Collective. */
PETSC_INTERN PetscErrorCode EqmCornersFromInput(EqmMesh mesh, const PetscInt corners[4], const PetscReal *arc,
                                                PetscReal corner_arc[4]);
/* They must be different and in the boundary's order, in any rotation. Errors: EQM_ERR_USAGE. Collective. */
PETSC_INTERN PetscErrorCode EqmCornersCheckOrder(EqmMesh mesh, const PetscReal corner_arc[4]);
/* The boundary's sharp vertices where there are four, unless a triangle would be flat with these; else the boundary
   vertices nearest to the quarters of its length. Errors: EQM_ERR_MESH (too few boundary vertices). Collective. */
PETSC_INTERN PetscErrorCode EqmCornersChoose(EqmMesh mesh, const PetscReal *arc, PetscReal corner_arc[4]);
/* Does every triangle have room? Errors: EQM_ERR_MESH (three vertices on one side: flat in every map). Collective. */
PETSC_INTERN PetscErrorCode EqmCornersCheckCells(EqmMesh mesh, const PetscReal *arc, const PetscReal corner_arc[4]);
/* Which side a boundary vertex lies on and how far along it; at a corner the fraction is 0. Not collective. */
static inline PetscInt EqmSquareSide(const PetscReal corner_arc[4], PetscReal arc, PetscReal *fraction)
{
  for (PetscInt side = 0; side < 4; side++) {
    const PetscReal begin = corner_arc[side];
    PetscReal length = corner_arc[(side + 1) % 4] - begin, along = arc - begin;
    if (length <= 0.) length += 1.;
    if (along < 0.) along += 1.;
    if (along < length) {
      *fraction = along / length;
      return side;
    }
  }
  *fraction = 0.;
  return 0;
}

#endif
