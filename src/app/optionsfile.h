/* Files of options. */
#ifndef EQM_OPTIONSFILE_H
#define EQM_OPTIONSFILE_H

#include <petscsys.h>

/* Insert the options of a file, YAML if its name ends in .yaml or .yml. options - NULL: PETSc's own. Errors: EQM_ERR_IO
   (it cannot be read), EQM_ERR_USAGE (it is none, or it asks for more than options). Collective on PETSC_COMM_WORLD. */
PETSC_INTERN PetscErrorCode EqmOptionsFileInsert(PetscOptions options, const char *file);

#endif
