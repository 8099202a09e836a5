/* What the files of the substructuring solver share. */
#ifndef EQM_SUBSTRUCTURE_H
#define EQM_SUBSTRUCTURE_H

#include "linalg/linalg.h"
#include "linalg/cholmod_name.h"
#include "linalg/interface.h"

/* Unknowns of this rank's matrix: first the inner ones, then those of the separators. */
typedef struct {
  cholmod_common common;
  cholmod_sparse matrix;
  cholmod_factor *factor; /* NULL: nothing is inner */
  cholmod_dense *right, *forward, *backward, *work_y, *work_e;
  PetscInt num_inner, num_edge;
  PetscInt *local;     /* per owned unknown */
  PetscInt *position;  /* per unknown: row of the factor */
  PetscInt *corner_at; /* per row of the factor: row of the corner, -1 for an inner unknown */
  PetscInt *source;    /* per entry of the matrix: place as in EqmBlocks, minus one minus that of the second block's */
  PetscInt num_direct, *direct; /* entries between separators: source, row, column among them */
  PetscInt *edge_vertex, *edge_component, *edge_links, *edge_unknown; /* per separator unknown; global number */
  PetscScalar *shift;                                                 /* D */
  PetscInt *place;     /* per separator unknown: which of them it is in the order of elimination */
  PetscScalar *corner; /* their block of the factor, by columns, in that order */
  EqmInterface interface;
} EqmSubstructure;

/* Symbolic work: what is inner, the pattern of the rank's matrix, its symbolic factor, the tree of fronts. Collective.
 */
PETSC_INTERN PetscErrorCode EqmSubstructureAnalyse(EqmLinear linear, EqmOrdering ordering);
/* Fail on all ranks if CHOLMOD failed on one. Collective. */
PETSC_INTERN PetscErrorCode EqmSubstructureAgree(EqmLinear linear, const char *what);
/* Solve with the factors; `success` stays as it is. Collective. */
PETSC_INTERN PetscErrorCode EqmSubstructureSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                                 PetscBool *success);

#endif
