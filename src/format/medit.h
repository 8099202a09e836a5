/* What the text and the binary form of Medit's format share. */
#ifndef EQM_FORMAT_MEDIT_H
#define EQM_FORMAT_MEDIT_H

#include "builder.h"

/* A kind of cells: its keyword in text and its code in binary files. */
typedef struct {
  const char *keyword;
  PetscInt code, dimension, num_corners;
  PetscBool wanted; /* faces and tetrahedra; the others are only noted */
} EqmMeditKind;

#define EQM_MEDIT_NUM_KINDS 8
PETSC_INTERN const EqmMeditKind EqmMeditKinds[EQM_MEDIT_NUM_KINDS];

enum { EQM_MEDIT_MAX_CORNERS = 4 }; /* of a cell that is wanted */

/* num_vertices - of the whole file. */
PETSC_INTERN PetscErrorCode EqmMeditStartCells(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                                               PetscInt64 count);
PETSC_INTERN PetscErrorCode EqmMeditAddCell(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                                            const PetscInt64 *vertices, PetscInt64 reference);

#endif
