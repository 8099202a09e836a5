/* A tree of boxes over the simplices of one rank. */
#ifndef EQM_TREE_H
#define EQM_TREE_H

#include "register/closest.h"

typedef struct {
  PetscReal low[3], high[3];
} EqmBox;

/* The simplex closest to a point. */
typedef struct {
  PetscInt cell;     /* among those the tree was made of; -1: none */
  PetscInt label;    /* its label: of equally close cells the lowest is taken */
  PetscReal squared; /* distance, 0 if within the tolerance */
  PetscReal barycentric[4];
} EqmHit;

/* Perfectly balanced: node 2 k and 2 k + 1 are the children of node k, node 1 is the root; the nodes of a level share
   the cells evenly. */
typedef struct {
  EqmImageKind kind;
  PetscInt cell_size, num_cells, num_levels;
  PetscInt *order;   /* cells as the leaves have them */
  PetscInt *label;   /* per cell */
  PetscReal *corner; /* 3 cell_size per cell: places of its corners, z = 0 in the plane */
  EqmBox *box;       /* per node, from 1 */
  PetscReal tolerance;
} EqmTree;

PETSC_INTERN PetscReal EqmBoxSquaredDistance(const EqmBox *box, const PetscReal y[3]);
/* The tree takes `corner` and `label` over. Not collective. */
PETSC_INTERN PetscErrorCode EqmTreeCreate(EqmImageKind kind, PetscInt cell_size, PetscInt num_cells, PetscReal *corner,
                                          PetscInt *label, PetscReal tolerance, EqmTree *tree);
PETSC_INTERN PetscErrorCode EqmTreeReset(EqmTree *tree);
/* Search for a cell that is closer than `hit`, or as close with a lower label. Not collective. */
PETSC_INTERN void EqmTreeFind(const EqmTree *tree, const PetscReal y[3], EqmHit *hit);

#endif
