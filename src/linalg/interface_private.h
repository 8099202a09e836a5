/* What building the tree, factoring and solving know of each other. */
#ifndef EQM_INTERFACE_PRIVATE_H
#define EQM_INTERFACE_PRIVATE_H

#include "linalg/interface.h"
#include <petscblaslapack.h>

/* Of the messages to the rank above and back. */
enum { EQM_TAG_SHAPE = 4101, EQM_TAG_MATRIX, EQM_TAG_UP, EQM_TAG_DOWN };

/* A merge of two groups of ranks, led by the lowest rank of the first. Its unknowns: those eliminated here, then those
   passed on. */
typedef struct {
  PetscMPIInt low, high, right; /* ranks low .. high - 1; `right` leads the second group, low the first */
  PetscInt num_out, num_kept;
  PetscInt num_from[2], *place[2]; /* where the unknowns of either group stand in this front */
  PetscScalar *panel;              /* columns of the eliminated ones: lower triangle of the factor */
  PetscScalar *columns;            /* right-hand sides during a solve */
} EqmFront;

struct _p_EqmInterface {
  MPI_Comm comm;
  PetscMPIInt parent; /* the rank that takes what is left of the last front; -1: this is the root */
  PetscInt num_fronts, num_shared, num_left;
  EqmFront *front; /* those that this rank leads, from the leaf to the root */
};

#endif
