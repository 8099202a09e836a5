/* What a step of the preparation is; private to this folder. */
#ifndef EQM_STEP_H
#define EQM_STEP_H

#include "mesh/subdivide.h"
#include "prepare/prepare.h"

/* A change of a soup: what a step makes, in the numbers of the soup before. */
typedef struct {
  EqmSoup soup;     /* replaced by the step, or left alone where there is nothing to do: the report's count is then 0 */
  EqmRepair repair; /* what EqmSoupRepair has counted */
  PetscInt *parent; /* per cell of the new slab: cell before, -1: added */
  PetscBool renumbers; /* vertices of the soup before have other numbers now: */
  PetscInt *vertex;    /* with it, per vertex of the slab before: number after */
} EqmChange;

typedef struct {
  const char *name, *purpose;
  PetscErrorCode (*run)(const EqmPrepareOptions *options, EqmChange *change, EqmPreparedStep *report);
} EqmPrepareStep;

PETSC_INTERN PetscErrorCode EqmStepWeld(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepSplit(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepFlat(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepLargest(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepHoles(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepHandles(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);
PETSC_INTERN PetscErrorCode EqmStepRepair(const EqmPrepareOptions *, EqmChange *, EqmPreparedStep *);

/* Replace the soup of a change by one with these added vertices and the cells of the list. Collective. */
PETSC_INTERN PetscErrorCode EqmChangeAssemble(EqmChange *change, EqmVertexGroup *added, EqmCellList *list);

/* The `num` vertices `from` of the soup before (ascending, the same on all ranks) have the numbers `to` now; call it
   before the soup is replaced. Not collective. */
PETSC_INTERN PetscErrorCode EqmChangeRenumber(EqmChange *change, PetscInt num, const PetscInt *from,
                                              const PetscInt *to);

/* The cells that a step has just added weigh `weight` times their measure. Not collective. */
PETSC_INTERN PetscErrorCode EqmChangeWeighAdded(EqmChange *change, PetscReal weight);
/* What `holes` does for solids. */
PETSC_INTERN PetscErrorCode EqmFillCavities(const EqmPrepareOptions *options, EqmChange *change,
                                            EqmPreparedStep *report);

/* A piece of a mesh. */
typedef struct {
  PetscInt label; /* its lowest vertex */
  PetscReal measure;
} EqmFoundPiece;

/* The pieces that EqmVicinityLabelComponents has labelled, the largest first, on every rank: a list as long as there
   are pieces, to be freed with PetscFree. Collective. */
PETSC_INTERN PetscErrorCode EqmListPieces(const EqmVicinity *vicinity, const PetscInt *label, PetscInt *num_pieces,
                                          EqmFoundPiece **all);

/* A boundary edge with its position, surface on its left. */
typedef struct {
  PetscInt tail, head;
  PetscReal x[3]; /* of the tail */
} EqmBoundaryEdge;

/* A patch that fills a loop of `num_boundary` vertices, counterclockwise: those first, then added ones. */
typedef struct {
  PetscInt num_boundary, num_vertices, num_triangles;
  PetscReal *position; /* 3 * num_vertices */
  PetscInt *triangle;  /* 3 * num_triangles */
} EqmPatch;

/* `forbidden` edges, pairs of places in the loop with the lower first in ascending order, are edges of the mesh
   already. Not collective. */
PETSC_INTERN PetscErrorCode EqmPatchCreate(PetscInt n, const PetscReal *loop, PetscInt num_forbidden,
                                           const PetscInt (*forbidden)[2], EqmPatch *patch);
PETSC_INTERN PetscErrorCode EqmPatchRefine(PetscInt num_forbidden, const PetscInt (*forbidden)[2], EqmPatch *patch);
PETSC_INTERN PetscErrorCode EqmPatchReset(EqmPatch *patch);
/* For qsort: the order of forbidden edges. */
PETSC_INTERN int EqmComparePairs(const void *a, const void *b);
PETSC_INTERN PetscBool EqmPatchIsForbidden(PetscInt a, PetscInt b, PetscInt num_forbidden,
                                           const PetscInt (*forbidden)[2]);

#endif
