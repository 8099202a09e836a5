/* VTK's XML files, whole or in parts. */
#ifndef EQM_FORMAT_VTU_H
#define EQM_FORMAT_VTU_H

#include "builder.h"
#include "vtuarray.h"

/* EqmVtuParseDocument - the mesh of a document, or with encoding->file this rank's part of it, for which it must be of
   one piece. Not collective. Errors: EQM_ERR_IO, EQM_ERR_MESH (quiet). */
PETSC_INTERN PetscErrorCode EqmVtuParseDocument(EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr root);
/* EqmVtuParsePart - see EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmVtuParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);

#endif
