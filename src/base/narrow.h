/* Checked conversion of numbers for libraries whose integers may be narrower than PETSc's. */
#ifndef EQM_NARROW_H
#define EQM_NARROW_H

#include <petscsys.h>

/* EqmCheckFits - fail if a number does not fit a signed integer of `width` bytes; call it before every conversion to
   the integers of another library.

   Not collective. `library` and `what`: whose integers, and what is counted, for the message. Errors: PETSC_ERR_SUP. */
PETSC_INTERN PetscErrorCode EqmCheckFits(PetscInt64 number, size_t width, const char *library, const char *what);

#endif
