/* The header of a PLY file: which numbers follow, and what they are. */
#ifndef EQM_FORMAT_PLY_H
#define EQM_FORMAT_PLY_H

#include "builder.h"
#include "part.h"
#include "scalar.h"

typedef enum {
  EQM_PLY_ROLE_NONE,
  EQM_PLY_ROLE_X,
  EQM_PLY_ROLE_Y,
  EQM_PLY_ROLE_Z,
  EQM_PLY_ROLE_S, /* texture coordinates of a vertex */
  EQM_PLY_ROLE_T,
  EQM_PLY_ROLE_CORNERS,
  EQM_PLY_ROLE_TEXTURE, /* of the corners of a face, two numbers each */
  EQM_PLY_NUM_ROLES
} EqmPlyRole;

typedef struct {
  EqmScalarType count_type; /* EQM_SCALAR_NONE: one number, not a list */
  EqmScalarType type;
  EqmPlyRole role;
  const char *name; /* in the header */
  size_t name_length;
  PetscReal *values; /* where a property without a role goes, or NULL */
} EqmPlyProperty;

#define EQM_PLY_MAX_PROPERTIES 128 /* of one element; the files of scanners have about twenty */
#define EQM_PLY_MAX_ELEMENTS   32

typedef struct {
  PetscBool is_vertex, is_face, is_strips, has_texture;
  PetscInt64 count;
  const char *position; /* of the header line, for messages */
  PetscInt num_properties;
  EqmPlyProperty property[EQM_PLY_MAX_PROPERTIES];
} EqmPlyElement;

typedef struct {
  PetscBool ascii, big_endian;
  PetscInt num_elements;
  PetscInt64 num_vertices;
  PetscBool textured; /* vertices have texture coordinates */
  EqmPlyElement element[EQM_PLY_MAX_ELEMENTS];
} EqmPlyHeader;

PETSC_INTERN PetscErrorCode EqmPlyParseHeader(EqmInput *in, EqmPlyHeader *header);
PETSC_INTERN size_t EqmPlySmallestRow(const EqmPlyHeader *header, const EqmPlyElement *element);
PETSC_INTERN PetscErrorCode EqmPlyParseRows(EqmInput *in, const EqmPlyHeader *header, EqmPlyElement *element,
                                            EqmBuilder *builder);
/* EqmPlyRowsOfPart - this rank's rows of an element of a binary file that begins at byte `begin`: their bytes (NULL
   where there are none or they cannot be read; PetscFree them) and number. end - of the element. understood - false on
   every rank if the file is too short or cannot be read on one. Collective. */
PETSC_INTERN PetscErrorCode EqmPlyRowsOfPart(const EqmPartFile *file, const EqmPlyHeader *header,
                                             const EqmPlyElement *element, PetscInt64 begin, EqmFilePart *part,
                                             PetscInt64 *count, PetscInt64 *end, PetscBool *understood);
/* EqmPlyParsePart - see EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmPlyParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);

#endif
