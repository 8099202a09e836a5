/* What the files of the multifrontal factor share. */
#ifndef EQM_FRONTAL_PRIVATE_H
#define EQM_FRONTAL_PRIVATE_H

#include "linalg/frontal.h"
#include "linalg/dense.h"

/* A front is a dense symmetric matrix over the rows of a supernode: first its columns, which are eliminated there, then
   the rest, whose matrix (its update) its parent takes. Fronts are numbered in a postorder: those below front k are
   first_below[k] .. k - 1. */
struct _p_EqmFrontal {
  cholmod_common common;
  cholmod_factor *symbolic; /* CHOLMOD's analysis; the values are ours */
  PetscInt num_unknowns, num_entries, num_fronts;
  const PetscInt *column;      /* of CHOLMOD: per front its first column ... */
  const PetscInt *row_start;   /* ... where its rows begin in `row` ... */
  const PetscInt *value_start; /* ... where the columns of its factor begin in `value`: rows x columns, by columns */
  const PetscInt *row;
  PetscInt *position;            /* per unknown: its row */
  PetscInt *parent;              /* per front; -1: none */
  PetscInt *child_start, *child; /* per front its children, ascending; at num_fronts those that have no parent */
  PetscInt *first_below;
  PetscInt *at_parent; /* per entry of `row` beyond the columns: which row of the parent's front */
  PetscInt *entry_start, *entry_source, *entry_target; /* per front entries of the matrix: which, and to which value */

  /* Branches of little work go to one thread each; the fronts above them are tasks of their own. */
  unsigned char *is_branch;      /* per front: it ends a branch */
  unsigned char *is_inside;      /* it is within a branch, its end included */
  PetscInt *at_end;              /* within a branch, per row beyond it: which of those of its end */
  size_t *stack;                 /* per end of a branch: numbers that the updates within take at most */
  size_t *most_panel;            /* of the columns of a front, or of one within a branch: numbers */
  PetscInt *most_rows;           /* of a front, or within a branch */
  PetscInt *passed_start;        /* per front outside branches and end of one: where in `passed` */
  PetscReal flops;               /* of a factorisation */
  PetscBool is_single;           /* the factor is kept in single precision */
  void *value;                   /* the factor, in either */
  PetscScalar **panel, **update; /* of a front at work its columns; its update, until the parent has taken it */
  PetscInt num_kept;             /* unknowns whose block of the factor is wanted; where they are in it; the block */
  const PetscInt *kept_at;
  PetscScalar *kept_block;
  PetscScalar *columns, *passed; /* of a solve: right-hand sides, what fronts hand to their parents */
  int not_definite, no_memory;   /* found by any thread */
};

/* Which part of a factor's work is worth the threads; a front whose work is divided. */
static const PetscReal EQM_FRONTAL_LEAST_FLOPS = 1e6;

static inline PetscInt EqmFrontColumns(EqmFrontal f, PetscInt k)
{
  return f->column[k + 1] - f->column[k];
}

static inline PetscInt EqmFrontRows(EqmFrontal f, PetscInt k)
{
  return f->row_start[k + 1] - f->row_start[k];
}

/* Numbers in a front's columns. */
static inline size_t EqmFrontPanel(EqmFrontal f, PetscInt k)
{
  return (size_t)EqmFrontRows(f, k) * (size_t)EqmFrontColumns(f, k);
}

/* Rows of a front's update matrix. */
static inline PetscInt EqmFrontRest(EqmFrontal f, PetscInt k)
{
  return EqmFrontRows(f, k) - EqmFrontColumns(f, k);
}

#endif
