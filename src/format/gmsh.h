/* What the versions of Gmsh's MSH format share. */
#ifndef EQM_FORMAT_GMSH_H
#define EQM_FORMAT_GMSH_H

#include "builder.h"
#include "scalar.h"
#include "tagmap.h"

/* A part of the geometry, and the first physical group that it belongs to. */
typedef struct {
  PetscInt64 dimension, tag, group;
} EqmGmshEntity;

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  EqmTagMap tags;
  PetscBool ascii, big_endian, version_4_0;
  PetscBool has_nodes;
  PetscInt64 num_entities, entity_capacity; /* surfaces and volumes of version 4 that are in a physical group */
  EqmGmshEntity *entities;
  char *names[2]; /* of physical groups of dimension 2 and 3, as metadata */
} EqmGmsh;

PETSC_INTERN PetscErrorCode EqmGmshReadInteger(EqmGmsh *gmsh, EqmScalarType type, const char *what, PetscInt64 *value);
PETSC_INTERN PetscErrorCode EqmGmshReadCount(EqmGmsh *gmsh, EqmScalarType type, const char *what, size_t bytes_each,
                                             PetscInt64 *count);
PETSC_INTERN PetscErrorCode EqmGmshReadTag(EqmGmsh *gmsh, EqmScalarType type);
PETSC_INTERN PetscErrorCode EqmGmshReadPoint(EqmGmsh *gmsh, PetscReal point[3]);
PETSC_INTERN PetscErrorCode EqmGmshCloseNodes(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshNodesOfType(EqmGmsh *gmsh, PetscInt64 type, PetscInt *num_nodes);
PETSC_INTERN PetscErrorCode EqmGmshReadElement(EqmGmsh *gmsh, PetscInt64 type, PetscInt num_nodes, EqmScalarType index);
PETSC_INTERN PetscErrorCode EqmGmshParseNodes2(EqmGmsh *gmsh, PetscBool parametric);
PETSC_INTERN PetscErrorCode EqmGmshParseElements2(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseNodes4(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseElements4(EqmGmsh *gmsh);

PETSC_INTERN PetscErrorCode EqmGmshParseNames(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseEntities(EqmGmsh *gmsh);
PETSC_INTERN PetscInt64 EqmGmshGroupOf(const EqmGmsh *gmsh, PetscInt64 dimension, PetscInt64 tag);

#endif
