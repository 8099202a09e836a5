/* What the files of this room share. */
#ifndef EQM_STORE_H
#define EQM_STORE_H

#include <equimap/map.h>

PETSC_INTERN PetscBool EqmHasSuffix(const char *name, const char *suffix);
PETSC_INTERN PetscErrorCode EqmMapWriteResult(EqmMap map, const char *file);
PETSC_INTERN PetscErrorCode EqmMapWriteXdmf(EqmMap map, const char *result_file);
PETSC_INTERN PetscErrorCode EqmMapDropExtras(EqmMap map);
PETSC_INTERN PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file);

#endif
