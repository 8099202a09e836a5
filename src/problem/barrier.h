/* A barrier against folds of maps to the ball that maps with folds can cross: barrier.c defines it. */
#ifndef EQM_BARRIER_H
#define EQM_BARRIER_H

#include "problem/problem.h"
#include "problem/term.h"
#include "energy/cellframe.h"

typedef struct _p_EqmBarrier *EqmBarrier;
struct _p_EqmBarrier {
  struct _p_EqmTerm term;         /* without a weight of its own */
  PetscReal weight, shape_weight; /* lambda and sigma */
  PetscReal epsilon;              /* how soft it is; never 0, what is next to nothing makes it a wall */
  PetscReal center[3];            /* of the domain */
  PetscReal total;                /* the volume that ratios refer to, held */
  PetscInt num_facets;            /* of the whole boundary */
  PetscReal *share;               /* of the surface, per boundary facet */
  PetscBool *counts;              /* per boundary facet: this rank adds it up */
  PetscInt *facet_of;             /* per local cell and face: its boundary facet, -1 where it is none */
  PetscReal *edge;         /* per local cell and edge: |F|^2 = sum edge |x_i - x_j|^2, F with the cell's derivative
                              from its shape at the volume that it is to have */
  PetscReal *slope, *flow; /* per local cell: by the volume; per edge: by |x_i - x_j|^2 / 2 */
  PetscReal *ambient, *part;
};

/* The function of one cell by its volume ratio: value and two derivatives. */
typedef struct {
  PetscReal value, first, second;
  PetscReal by_stretch; /* by |F|^2 */
} EqmBarrierTerm;

PETSC_INTERN PetscErrorCode EqmBarrierCreate(EqmProblem problem, const EqmPlace *place, EqmBarrier *barrier);
PETSC_INTERN PetscErrorCode EqmBarrierDestroy(EqmBarrier *barrier);
/* Not collective. */
PETSC_INTERN EqmBarrierTerm EqmBarrierOfCell(EqmBarrier barrier, PetscReal ratio, PetscReal stretch);
/* |F|^2 of a cell. Not collective. */
PETSC_INTERN PetscReal EqmBarrierStretch(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt cell);
/* Volume of the cell between the domain's centre and a boundary facet over what it should be. Not collective. */
PETSC_INTERN PetscReal EqmBarrierFacetRatio(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt facet);
/* Six times the derivative of that cell's volume by its corner number b. Not collective. */
PETSC_INTERN void EqmBarrierFacetNormal(EqmBarrier barrier, EqmMesh mesh, const PetscReal *x, PetscInt facet,
                                        PetscInt b, PetscReal normal[3]);
/* The smallest ratio of cells and boundary facets of an iterate, and how many of both are folded. Collective. */
PETSC_INTERN PetscErrorCode EqmBarrierInspect(EqmBarrier barrier, EqmProblem problem, EqmIterate iterate,
                                              PetscReal *least, PetscInt64 *folds);
/* The term's add_matrix (barrier_cell.c). Not collective. */
PETSC_INTERN void EqmBarrierAddMatrix(EqmTerm term, EqmProblem problem, const EqmPlace *place, const PetscReal *image,
                                      PetscInt cell, const EqmCellFrame *frame, PetscReal factor, PetscReal *matrix);

#endif
