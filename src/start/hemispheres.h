/* A closed surface cut in two by a closed curve, and maps of both parts to hemispheres with weights of several kinds
   (004 section 5.1). */
#ifndef EQM_HEMISPHERES_H
#define EQM_HEMISPHERES_H

#include "start/start.h"
#include "mesh/mesh_private.h"

/* A triangle that the curve runs through, from the crossing of one edge to that of another. */
typedef struct {
  PetscInt from[2], to[2]; /* the edges: input numbers of their lower and higher end */
  PetscReal place[3];      /* where the first edge is crossed, on the surface */
  PetscReal angle;         /* of that crossing along the curve */
} EqmCrossing;

typedef struct {
  EqmProblem problem;
  PetscReal *input;  /* input number per local vertex */
  PetscReal *height; /* the function, per local vertex */
  PetscReal level;
  PetscInt count;        /* of all ranks */
  EqmCrossing *crossing; /* sorted by `from`; the same on every rank: as long as the curve, not as the mesh. Of n
                            vertices it crosses 3.3 to 3.8 sqrt(n) triangles, limbs or none (docs/performance.md) */
} EqmCut;

static inline PetscBool EqmCutIsBelow(const EqmCut *cut, PetscInt v)
{
  return (PetscBool)(cut->height[v] < cut->level);
}

/* Order the crossings as EqmCutFindCrossing wants them. Not collective. */
PETSC_INTERN void EqmCutSort(EqmCut *cut);
/* The crossing that leaves the edge (below, above), input numbers; NULL if the curve does not cross it. Not collective.
 */
PETSC_INTERN EqmCrossing *EqmCutFindCrossing(const EqmCut *cut, PetscInt below, PetscInt above);

/* Map both parts: each vertex is the mean of its neighbours with these weights, the curve lies on the equator by arc
   length. Errors: EQM_ERR_MESH (the weights' matrix is singular, or of harmonic ones not positive definite).
   Collective. */
PETSC_INTERN PetscErrorCode EqmHemispheresMap(const EqmCut *cut, EqmHemisphereWeights kind, EqmIterate iterate,
                                              signed char *group);

#endif
