/* What the files of this room share. */
#ifndef EQM_STORE_H
#define EQM_STORE_H

#include <equimap/map.h>

PETSC_INTERN PetscBool EqmHasSuffix(const char *name, const char *suffix);
/* NAME.h5 -> NAME`suffix`; what does not end in .h5 gets the suffix behind. */
PETSC_INTERN PetscErrorCode EqmNameBeside(const char *file, const char *suffix, char *name, size_t length);
PETSC_INTERN PetscErrorCode EqmMapWriteResult(EqmMap map, const char *file);
PETSC_INTERN PetscErrorCode EqmMapWriteXdmf(EqmMap map, const char *result_file);
/* Where frame number %d of a morph stands in the result file. */
#define EQM_FRAME_PATH "/morph/frame_%03" PetscInt_FMT
PETSC_INTERN PetscErrorCode EqmMapWriteMorph(EqmMap map, const char *result_file, PetscInt num_frames);
PETSC_INTERN PetscErrorCode EqmMapDropExtras(EqmMap map);
PETSC_INTERN PetscErrorCode EqmMapWriteImage(EqmMap map, const char *file);

#endif
