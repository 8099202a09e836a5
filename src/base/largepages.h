/* Large pages for large arrays, where the system leaves it to programs to ask for them. */
#ifndef EQM_LARGEPAGES_H
#define EQM_LARGEPAGES_H

#include <petscsys.h>

/* From now on arrays that come from PetscMalloc ask for large pages. Not under PETSc's tracing of memory. Once; not
   collective. */
PETSC_INTERN PetscErrorCode EqmUseLargePages(void);

#endif
