/* Nodes and elements of MSH 2.2. */
#include "gmsh.h"

/* What follows the coordinates in $ParametricNodes: dimension and tag of the entity that the node lies on, one
   parameter on a curve, two on a surface. */
static PetscErrorCode SkipParameters(EqmGmsh *gmsh)
{
  PetscInt64 dimension, unused;
  const char *skipped;

  if (gmsh->ascii) {
    EqmSkipLine(gmsh->in);
    return 0;
  }
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the dimension of an entity", &dimension));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the tag of an entity", &unused));
  return EqmTakeBytes(gmsh->in, dimension == 1 ? 8 : dimension == 2 ? 16 : 0, "parameters of a node", &skipped);
}

/* EqmGmshParseNodes2 - the section $Nodes, or $ParametricNodes, of version 2.2. Not collective. Errors: EQM_ERR_IO
   (quiet). */
PetscErrorCode EqmGmshParseNodes2(EqmGmsh *gmsh, PetscBool parametric)
{
  const size_t bytes_each = gmsh->ascii ? 8 : 28;
  PetscInt64 count;
  PetscReal *x;

  EqmSkipSpace(gmsh->in, 0);
  EqmTry(EqmReadCount(gmsh->in, "nodes", bytes_each, &count));
  EqmSkipLine(gmsh->in);
  EqmTry(EqmBuilderAddVertices(&gmsh->builder, (size_t)count, &x));
  EqmTry(EqmTagMapReserve(&gmsh->tags, (size_t)count));
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmGmshReadTag(gmsh, EQM_SCALAR_INT32));
    EqmTry(EqmGmshReadPoint(gmsh, x + 3 * i));
    if (parametric) EqmTry(SkipParameters(gmsh));
  }
  return 0;
}

/* One line: number, type, number of tags, tags, nodes. */
static PetscErrorCode ParseAsciiElement(EqmGmsh *gmsh)
{
  PetscInt64 number, type, num_tags, group = 0;
  PetscInt num_nodes;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the number of an element", &number));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the type of an element", &type));
  EqmTry(EqmGmshNodesOfType(gmsh, type, &num_nodes));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of tags of an element", 2, &num_tags));
  for (PetscInt64 k = 0; k < num_tags; ++k) {
    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "a tag of an element", &number));
    if (k == 0) group = number; /* the physical one comes first */
  }
  EqmBuilderSetGroup(&gmsh->builder, group);
  return EqmGmshReadElement(gmsh, type, num_nodes, EQM_SCALAR_INT32);
}

/* A header and its elements of one type; `done` counts on. */
static PetscErrorCode ParseBinaryElements(EqmGmsh *gmsh, PetscInt64 *done)
{
  PetscInt64 type, count, num_tags;
  PetscInt num_nodes;
  const char *tags;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the type of elements", &type));
  EqmTry(EqmGmshNodesOfType(gmsh, type, &num_nodes));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of elements", 8, &count));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of tags", 4, &num_tags));
  if (!count) return EqmReject(gmsh->in, EQM_ERR_IO, "a block without elements: the file is damaged");
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmTakeBytes(gmsh->in, 4 * (1 + (size_t)num_tags), "tags of an element", &tags));
    EqmBuilderSetGroup(&gmsh->builder, num_tags ? EqmLoadInteger(tags + 4, EQM_SCALAR_INT32, gmsh->big_endian) : 0);
    EqmTry(EqmGmshReadElement(gmsh, type, num_nodes, EQM_SCALAR_INT32));
  }
  *done += count;
  return 0;
}

/* EqmGmshParseElements2 - the section $Elements of version 2.2. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseElements2(EqmGmsh *gmsh)
{
  PetscInt64 count, done = 0;

  EqmSkipSpace(gmsh->in, 0);
  EqmTry(EqmReadCount(gmsh->in, "elements", 8, &count));
  EqmSkipLine(gmsh->in);
  while (done < count) {
    if (!gmsh->ascii) {
      EqmTry(ParseBinaryElements(gmsh, &done));
    } else {
      EqmTry(ParseAsciiElement(gmsh));
      ++done;
    }
  }
  return 0;
}
