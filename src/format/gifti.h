/* What a surface is to readers of GIFTI: its geometric type and the hemisphere that it is of. */
#ifndef EQM_GIFTI_H
#define EQM_GIFTI_H

#include "format.h"

/* GeometricType, from the points: on a sphere about the origin, flat, or what the input said. Not collective. */
PETSC_INTERN const char *EqmGiftiGeometricType(const EqmSerialMesh *mesh, char *value, size_t length);
/* AnatomicalStructurePrimary: what the input said, or what the file's name does in the manner of FreeSurfer (lh.) or
   HCP (.L.); false: nothing does. Not collective. */
PETSC_INTERN PetscBool EqmGiftiStructure(const EqmSerialMesh *mesh, const char *path, char *value, size_t length);

#endif
