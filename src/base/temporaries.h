/* The temporary files that this process has under way. */
#ifndef EQM_TEMPORARIES_H
#define EQM_TEMPORARIES_H

#include <petscsys.h>

/* A temporary is there; it is not there any more, under this name. Not collective. */
PETSC_INTERN void EqmNoteTemporary(const char *name);
PETSC_INTERN void EqmForgetTemporary(const char *name);

#endif
