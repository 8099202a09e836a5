/* Maps without folds at a cost that grows with the number of vertices: the coarsest level is mapped, vertices come back
   level by level, and each level is relaxed. */
#ifndef EQM_CASCADE_H
#define EQM_CASCADE_H

#include "hierarchy/hierarchy.h"

typedef enum { EQM_TARGET_DISK, EQM_TARGET_SQUARE, EQM_TARGET_SPHERE } EqmCascadeTarget;

typedef struct {
  PetscReal epsilon;        /* weight of the angle energy on all levels but the finest */
  PetscReal epsilon_finest; /* and on that */
  PetscInt sweeps;          /* over the vertices of each level, at most */
  PetscReal least_gain;     /* by which share of the objective two sweeps must lower it that others follow, and all of
                               them that steps follow, which sweeps cannot do for; 0: all are done */
  PetscInt steps;           /* Gauss-Newton steps by multigrid on each level */
  PetscInt direct;          /* levels with no more vertices have their matrices factored */
  PetscInt bottom;          /* and those at the bottom of multigrid with no more */
  PetscInt coarsest;        /* planar: a level with no more vertices is mapped first */
  PetscBool trace;          /* print a line per level */
} EqmCascadeOptions;
enum { EQM_SWEEPS_AFTER = 2 }; /* the steps */

typedef struct {
  PetscInt folds; /* of the finest map: triangles that arithmetic cannot tell from folded ones included */
  PetscReal energy, objective;
  PetscReal before;  /* the objective of the map that was given; infinite: it folds, or there was none */
  PetscReal epsilon; /* the weight that the angles had: as wanted, or less */
} EqmCascadeResult;

PETSC_INTERN PetscErrorCode EqmCascadeOptionsDefault(EqmCascadeOptions *options);
/* Map the surface to the target. `x`: two coordinates (sphere: three) per vertex of level 0; of the disk and the square
   those of boundary vertices are set on entry, in the boundary's order: on the unit circle, on the sides of the unit
   square with corners at the vertices that the hierarchy keeps as such. Works on the first rank; the result is known
   to all. Collective. */
PETSC_INTERN PetscErrorCode EqmCascade(EqmHierarchy hierarchy, EqmCascadeTarget target,
                                       const EqmCascadeOptions *options, PetscReal *x, EqmCascadeResult *result);
/* Relax a map of the finest level, x, as the cascade does it with its last: options->sweeps and steps. What folds is
   left as it is. Collective. */
PETSC_INTERN PetscErrorCode EqmCascadeRelax(EqmHierarchy hierarchy, EqmCascadeTarget target,
                                            const EqmCascadeOptions *options, PetscReal *x, EqmCascadeResult *result);

#endif
