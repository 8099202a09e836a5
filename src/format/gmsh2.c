/* Nodes and elements of MSH 2.2. */
#include "gmsh.h"

/* EqmGmshParseNodes2 - the section $Nodes of version 2.2. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseNodes2(EqmGmsh *gmsh)
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
    PetscInt64 tag;

    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the tag of a node", &tag));
    if (tag < 0) return EqmReject(gmsh->in, EQM_ERR_IO, "a node has the negative tag %lld", (long long)tag);
    EqmTagMapAdd(&gmsh->tags, tag);
    EqmTry(EqmGmshReadPoint(gmsh, x + 3 * i));
  }
  return 0;
}

/* One line: number, type, number of tags, tags, nodes. */
static PetscErrorCode ParseAsciiElement(EqmGmsh *gmsh)
{
  PetscInt64 number, type, num_tags;
  PetscInt num_nodes;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the number of an element", &number));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the type of an element", &type));
  EqmTry(EqmGmshNodesOfType(gmsh, type, &num_nodes));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of tags of an element", 2, &num_tags));
  for (PetscInt64 k = 0; k < num_tags; ++k) {
    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "a tag of an element", &number));
  }
  return EqmGmshReadElement(gmsh, type, num_nodes, EQM_SCALAR_INT32);
}

/* A header and its elements of one type; `done` counts on. */
static PetscErrorCode ParseBinaryElements(EqmGmsh *gmsh, PetscInt64 *done)
{
  PetscInt64 type, count, num_tags;
  PetscInt num_nodes;
  const char *skipped;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the type of elements", &type));
  EqmTry(EqmGmshNodesOfType(gmsh, type, &num_nodes));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of elements", 8, &count));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_INT32, "the number of tags", 4, &num_tags));
  if (!count) return EqmReject(gmsh->in, EQM_ERR_IO, "a block without elements: the file is damaged");
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmTakeBytes(gmsh->in, 4 * (1 + (size_t)num_tags), "tags of an element", &skipped));
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
