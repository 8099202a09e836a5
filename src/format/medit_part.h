/* Medit's text, read in parts, and what the parser of the whole file has for it. */
#ifndef EQM_FORMAT_MEDIT_PART_H
#define EQM_FORMAT_MEDIT_PART_H

#include "format.h"
#include "medit.h"

/* See EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmMeditParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);
/* The first keyword, after comments. Not collective. */
PETSC_INTERN PetscBool EqmMeditBegins(const char *bytes, size_t length);
/* A whole number behind blanks and comments. Not collective. Errors: EQM_ERR_IO (quiet). */
PETSC_INTERN PetscErrorCode EqmMeditReadInteger(EqmInput *in, const char *what, PetscInt64 *value);
/* `count` rows of vertices, or of cells of a wanted kind, at the cursor of the builder's input. num_vertices - of the
   whole file. Not collective. Errors: EQM_ERR_IO (quiet). */
PETSC_INTERN PetscErrorCode EqmMeditReadVertices(EqmBuilder *builder, PetscInt64 dimension, PetscInt64 count);
PETSC_INTERN PetscErrorCode EqmMeditReadCells(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                                              PetscInt64 count);

#endif
