/* What kind of domain an image fills, where it lies and how large it is: foreign maps are not always on the unit ones.
 */
#ifndef EQM_RECOGNISE_H
#define EQM_RECOGNISE_H

#include <equimap/mesh.h>

typedef enum {
  EQM_FILLS_DISK,   /* of the plane, its boundary on a circle */
  EQM_FILLS_SQUARE, /* of the plane, its boundary on an upright square */
  EQM_FILLS_PLANE,  /* of the plane, of another shape */
  EQM_FILLS_SPHERE, /* all vertices on a sphere */
  EQM_FILLS_SPACE,  /* another surface in space */
  EQM_FILLS_BALL,   /* a solid, its boundary on a sphere */
  EQM_FILLS_CUBE,   /* a solid, its boundary on an upright cube */
  EQM_FILLS_SOLID   /* another solid */
} EqmDomainShape;

/* The image is `center` + `size` times an image of the unit domain: radius 1, side 1, or area or volume 1. */
typedef struct {
  EqmDomainShape shape;
  PetscReal center[3], size;
} EqmImagePlacement;

PETSC_INTERN PetscErrorCode EqmImageRecognise(EqmMesh mesh, PetscInt dim, const PetscReal *x,
                                              EqmImagePlacement *placement);
PETSC_INTERN void EqmImageToUnit(EqmMesh mesh, PetscInt dim, const EqmImagePlacement *placement, PetscReal *x);
PETSC_INTERN const char *EqmDomainShapeName(EqmDomainShape shape);
/* The target whose unit domain has that shape; NULL: there is none. Not collective. */
PETSC_INTERN const char *EqmDomainShapeTarget(EqmDomainShape shape);

#endif
