/* Fields on the vertices or cells of a mesh, read to be carried to another. */
#ifndef EQM_TRANSFER_FIELD_H
#define EQM_TRANSFER_FIELD_H

#include <equimap/soup.h>

typedef struct {
  char name[64];  /* for the result's arrays */
  PetscBool of_b; /* transferred from B to A */
  PetscBool on_cells;
  PetscInt width;
  PetscReal *slab; /* width per vertex or cell of the soup's slab */
} EqmCarriedField;

/* Read "coordinates", a dataset of the soup's own HDF5 file ("/vertex/ratio"), or a CSV file with a header and a row
   per vertex or cell. Errors: EQM_ERR_IO, EQM_ERR_USAGE (as many rows as neither vertices nor cells). Collective. */
PETSC_INTERN PetscErrorCode EqmFieldRead(EqmSoup soup, const char *source, EqmCarriedField *field);
/* Multiply it by 2^exponent. Not collective. */
PETSC_INTERN PetscErrorCode EqmFieldShift(EqmSoup soup, PetscInt exponent, EqmCarriedField *field);
PETSC_INTERN PetscErrorCode EqmFieldReset(EqmCarriedField *field);

#endif
