/* What the parsers of Medit's .meshb share: that of a whole file and that of parts. */
#ifndef EQM_FORMAT_MESHB_H
#define EQM_FORMAT_MESHB_H

#include "format.h"
#include "medit.h"
#include "scalar.h"

enum { EQM_MESHB_DIMENSION = 3, EQM_MESHB_VERTICES = 4, EQM_MESHB_END = 54 };

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  PetscBool big_endian;
  EqmScalarType integer, offset, real; /* of this version */
  PetscInt64 dimension, num_vertices;  /* of the whole file */
} EqmMeshb;

/* Byte order and version; PETSC_FALSE if these are not the first bytes of a .meshb file. Not collective. */
PETSC_INTERN PetscBool EqmMeshbReadMagic(const char *bytes, size_t length, PetscBool *big_endian, PetscInt64 *version);
/* The integer at the cursor, which moves behind it. Not collective. Errors: EQM_ERR_IO (quiet). */
PETSC_INTERN PetscErrorCode EqmMeshbTakeInteger(EqmMeshb *meshb, EqmScalarType type, const char *what,
                                                PetscInt64 *value);
/* Bytes of a record. Not collective. */
PETSC_INTERN size_t EqmMeshbBytesOfVertex(const EqmMeshb *meshb);
PETSC_INTERN size_t EqmMeshbBytesOfCell(const EqmMeshb *meshb, const EqmMeditKind *kind);
/* Up to the dimension. Not collective. Errors: EQM_ERR_IO (quiet), as of the next two. */
PETSC_INTERN PetscErrorCode EqmMeshbParseHeader(EqmMeshb *meshb);
/* `count` records to the builder. Not collective. */
PETSC_INTERN PetscErrorCode EqmMeshbReadVertices(EqmMeshb *meshb, const char *records, PetscInt64 count);
PETSC_INTERN PetscErrorCode EqmMeshbReadCells(EqmMeshb *meshb, const EqmMeditKind *kind, const char *records,
                                              PetscInt64 count);
/* See EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmMeshbParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);

#endif
