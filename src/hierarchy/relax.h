/* One vertex against its star: the part of the objective that its place has a say in. */
#ifndef EQM_RELAX_H
#define EQM_RELAX_H

#include "hierarchy/level.h"
#include "hierarchy/levelmap.h"

typedef struct {
  PetscInt dim, size, num_cells; /* size: ring vertices; num_cells, or one more on the boundary */
  PetscReal total, balance;      /* A; epsilon / A */
  PetscBool area_varies;         /* the star's area depends on the centre's place */
  const PetscReal *weight;       /* per triangle */
  const PetscReal *cotangent; /* per ring vertex: half the sum of the cotangents beside the edge; NULL: epsilon = 0 */
  PetscReal (*ring)[3];       /* places of the ring vertices */
} EqmStarImage;

/* Infinite where a triangle is folded or too small to tell. Not collective. */
PETSC_INTERN PetscReal EqmStarImageValue(const EqmStarImage *star, const PetscReal *x);
/* Gauss-Newton steps of the centre, each shortened until the value falls. Not collective. */
PETSC_INTERN void EqmStarImageRelax(const EqmStarImage *star, EqmMotion motion, PetscInt steps, PetscReal *x);

/* The stars of all vertices of a level, for sweeps. */
typedef struct {
  PetscInt *start, *ring, most;
  PetscReal *weight, *cotangent;
  EqmLevelPieces vertices; /* those of different pieces are no neighbours */
} EqmLevelStars;
PETSC_INTERN PetscErrorCode EqmLevelStarsCreate(const EqmHierarchyLevel *level, EqmLevelStars *stars);
/* The stars of the first `num` vertices, without pieces. Not collective. */
PETSC_INTERN PetscErrorCode EqmLevelStarsFill(const EqmHierarchyLevel *level, PetscInt num, EqmLevelStars *stars);
PETSC_INTERN PetscErrorCode EqmLevelStarsDestroy(EqmLevelStars *stars);
/* Relax each vertex once, in the order within pieces and then back, in turn: `sweeps` in all. Never two neighbours at
   the same time, which might fold. Not collective. */
PETSC_INTERN PetscErrorCode EqmRelaxLevel(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt sweeps);
/* The vertices first, first + 1, ... of a list, once, or the other way round; `ring` is scratch for stars->most places.
   Not collective. */
PETSC_INTERN void EqmRelaxVertices(EqmLevelMap *map, const EqmLevelStars *stars, PetscInt num, const PetscInt *vertex,
                                   PetscBool backwards, PetscReal (*ring)[3]);

#endif
