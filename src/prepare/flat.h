/* Flat triangles and what is around them, on one rank; private to this folder. */
#ifndef EQM_FLAT_H
#define EQM_FLAT_H

#include "prepare/step.h"

/* A triangle as it is sent. */
typedef struct {
  PetscInt cell, vertex[3]; /* numbers in the soup */
  PetscReal x[9];
} EqmFlatRecord;

/* Triangles that are alive or have been replaced by others, which come after them. */
typedef struct {
  PetscInt num_given, num_cells, cell_capacity;
  PetscInt *cell;   /* the soup's cell that it is or comes from */
  PetscInt *corner; /* 3 each, places in `number` */
  PetscBool *alive;
  PetscInt num_vertices, *number;      /* in the soup, ascending */
  PetscReal *x;                        /* 3 each */
  PetscInt *head, *next;               /* of the list of corners at a vertex; per corner the next one, or -1 */
  PetscInt num_joined, *joined, *onto; /* vertices that went to others at the same place */
} EqmFlatPatch;

/* Make the patch of records. Not collective. */
PETSC_INTERN PetscErrorCode EqmFlatPatchCreate(PetscInt num, const EqmFlatRecord *record, EqmFlatPatch *patch);
PETSC_INTERN PetscErrorCode EqmFlatPatchReset(EqmFlatPatch *patch);
/* Flip or collapse what is flat, as long as something can be done; `mended` is how many. Not collective. */
PETSC_INTERN PetscErrorCode EqmFlatPatchMend(EqmFlatPatch *patch, PetscInt64 *mended);

#endif
