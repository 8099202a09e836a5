/* What the versions of Gmsh's MSH format share. */
#ifndef EQM_FORMAT_GMSH_H
#define EQM_FORMAT_GMSH_H

#include "builder.h"
#include "part.h"
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
  PetscInt version; /* 2 or 4; 0 before the section $MeshFormat */
  PetscBool ascii, big_endian, version_4_0;
  PetscBool has_nodes;
  PetscInt64 num_nodes;                 /* of the whole file, when all are read */
  PetscInt64 num_named, named_capacity; /* with `names_only`: the tags of the nodes that elements name */
  PetscInt64 *named;
  PetscBool names_only;
  PetscInt64 num_entities, entity_capacity; /* surfaces and volumes of version 4 that are in a physical group */
  EqmGmshEntity *entities;
  char *names[2]; /* of physical groups of dimension 2 and 3, as metadata */
} EqmGmsh;

/* Rows of one kind that follow each other in the file. */
typedef enum {
  EQM_GMSH_TAGS,    /* of nodes */
  EQM_GMSH_POINTS,  /* of nodes */
  EQM_GMSH_NODES,   /* a tag and a point */
  EQM_GMSH_ELEMENTS /* of one type, but for the text of version 2 */
} EqmGmshKind;

/* For MPI all members are of one type. */
typedef struct {
  PetscInt64 kind; /* EqmGmshKind */
  PetscInt64 count;
  PetscInt64 parametric, dimension; /* of points: parameters follow, of an entity of that dimension */
  PetscInt64 type, num_tags, group; /* of elements; tags of version 2 only, the group of version 4 */
  PetscInt64 first, row_bytes; /* where the rows are: number of the first line, 0; or its byte, and bytes of each */
} EqmGmshRun;

PETSC_INTERN PetscErrorCode EqmGmshReadInteger(EqmGmsh *gmsh, EqmScalarType type, const char *what, PetscInt64 *value);
PETSC_INTERN PetscErrorCode EqmGmshReadCount(EqmGmsh *gmsh, EqmScalarType type, const char *what, size_t bytes_each,
                                             PetscInt64 *count);
PETSC_INTERN PetscErrorCode EqmGmshReadTag(EqmGmsh *gmsh, EqmScalarType type);
PETSC_INTERN PetscErrorCode EqmGmshReadPoint(EqmGmsh *gmsh, PetscReal point[3]);
PETSC_INTERN PetscErrorCode EqmGmshReadRows(EqmGmsh *gmsh, const EqmGmshRun *run, PetscInt64 count);
PETSC_INTERN PetscErrorCode EqmGmshCloseNodes(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshNodesOfType(EqmGmsh *gmsh, PetscInt64 type, PetscInt *num_nodes);
PETSC_INTERN PetscErrorCode EqmGmshReadElement(EqmGmsh *gmsh, PetscInt64 type, PetscInt num_nodes, EqmScalarType index);
PETSC_INTERN PetscErrorCode EqmGmshParseNodes2(EqmGmsh *gmsh, PetscBool parametric);
PETSC_INTERN PetscErrorCode EqmGmshParseElements2(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseNodes4(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseElements4(EqmGmsh *gmsh);

/* EqmGmshParseSections - sections to the end of the input. EqmGmshTakeNames - names of groups become metadata of a mesh
   that has been made. EqmGmshReset - free all but the builder. Not collective. */
PETSC_INTERN PetscErrorCode EqmGmshParseSections(EqmGmsh *gmsh);
PETSC_INTERN void EqmGmshTakeNames(EqmGmsh *gmsh, EqmSerialMesh *mesh);
PETSC_INTERN PetscErrorCode EqmGmshReset(EqmGmsh *gmsh);

/* ---- in parts
   A survey finds the rows of nodes and elements from byte `begin` on, where the section of nodes begins; *runs are the
   same on every rank, PetscFree them. `understood` is false on every rank for what is not as it mostly is. */
typedef struct {
  EqmFilePart part; /* text: this rank's lines */
  PetscInt64 first_line, num_lines;
  PetscInt64 *line; /* num_lines + 1: where in `part` they begin; blank ones do not count */
  PetscInt64 num_runs;
  EqmGmshRun *runs;
} EqmGmshSurvey;

/* EqmGmshSurveyLines, EqmGmshSurveyBytes - of text, and of binary files. Collective. */
PETSC_INTERN PetscErrorCode EqmGmshSurveyLines(EqmGmsh *gmsh, const EqmPartFile *file, PetscInt64 begin,
                                               EqmGmshSurvey *survey, PetscBool *understood);
PETSC_INTERN PetscErrorCode EqmGmshSurveyBytes(EqmGmsh *gmsh, const EqmPartFile *file, PetscInt64 begin,
                                               EqmGmshSurvey *survey, PetscBool *understood);
/* EqmGmshHasRoom - can the rest of the file, from byte `at` on, hold so many of what takes `bytes_each` at least? As
   EqmGmshReadCount asks. Not collective. */
PETSC_INTERN PetscBool EqmGmshHasRoom(const EqmPartFile *file, PetscInt64 at, PetscInt64 bytes_each, PetscInt64 count);
/* EqmGmshAddRun - append a run. Not collective. */
PETSC_INTERN PetscErrorCode EqmGmshAddRun(EqmGmshSurvey *survey, const EqmGmshRun *run);
/* EqmGmshParsePart - see EqmPartParser. */
PETSC_INTERN PetscErrorCode EqmGmshParsePart(const EqmPartFile *file, EqmSerialMesh *mesh, PetscBool *understood);

PETSC_INTERN PetscErrorCode EqmGmshParseNames(EqmGmsh *gmsh);
PETSC_INTERN PetscErrorCode EqmGmshParseEntities(EqmGmsh *gmsh);
PETSC_INTERN PetscInt64 EqmGmshGroupOf(const EqmGmsh *gmsh, PetscInt64 dimension, PetscInt64 tag);

#endif
