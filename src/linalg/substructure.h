/* What the files of the substructuring solver share. */
#ifndef EQM_SUBSTRUCTURE_H
#define EQM_SUBSTRUCTURE_H

#include "linalg/linalg.h"
#include "linalg/frontal.h"
#include "linalg/interface.h"

/* Unknowns of this rank's matrix: first the inner ones, then those of the separators. */
typedef struct {
  cholmod_sparse matrix;
  EqmFrontal factor; /* NULL: nothing is inner */
  PetscInt num_inner, num_separator_unknowns;
  PetscInt *local;        /* per owned unknown */
  PetscInt *separator_at; /* per position in the order of elimination: row of the block, -1 for an inner unknown */
  PetscInt *source; /* per entry of the matrix: place as in EqmBlocks, minus one minus that of the second block's */
  PetscInt num_couplings, *coupling; /* entries between separators: source, row, column among them */
  PetscInt *separator_vertex, *separator_component, *separator_links; /* per separator unknown */
  PetscInt *separator_unknown;                                        /* its global number */
  PetscScalar *shift;                                                 /* D */
  PetscInt *place;     /* per separator unknown: which of them it is in the order of elimination */
  PetscScalar *block;  /* their block of the factor, by columns, in that order */
  PetscScalar *values; /* of a solve: per unknown of this rank's matrix and right-hand side */
  PetscInt num_rhs;    /* allocated right-hand sides */
  EqmInterface interface;
} EqmSubstructure;

/* Symbolic work: what is inner, the pattern of the rank's matrix, its symbolic factor, the tree of fronts. Collective.
 */
PETSC_INTERN PetscErrorCode EqmSubstructureAnalyse(EqmLinear linear, EqmOrdering ordering);
/* Fail on all ranks if one had too little memory for its part. Collective. */
PETSC_INTERN PetscErrorCode EqmSubstructureCheckMemory(EqmLinear linear, const char *what);
/* Solve with the factors; `success` stays as it is. Collective. */
PETSC_INTERN PetscErrorCode EqmSubstructureSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                                 PetscBool *success);

#endif
