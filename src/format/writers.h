/* Writers that have a file of their own, beside the parser's file, which holds the format's row. See EqmWriter and
 * EqmStreamWriter. */
#ifndef EQM_FORMAT_WRITERS_H
#define EQM_FORMAT_WRITERS_H

#include "format.h"

PETSC_INTERN PetscErrorCode EqmWritePly(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                        size_t error_length);
PETSC_INTERN PetscErrorCode EqmWriteVtu(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                        size_t error_length);
PETSC_INTERN PetscErrorCode EqmWriteVtk(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                        size_t error_length);
PETSC_INTERN PetscErrorCode EqmWriteGifti(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                                          PetscInt num_fields, char *error, size_t error_length);
PETSC_INTERN PetscErrorCode EqmWriteGmsh(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                         size_t error_length);

PETSC_INTERN PetscErrorCode EqmWriteObj(EqmAtomicFile *file, struct EqmMeshStream *stream, char *error,
                                        size_t error_length);

#endif
