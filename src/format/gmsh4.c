/* Nodes and elements of MSH 4.1: blocks, one per entity of the geometry. */
#include "gmsh.h"

/* Number of blocks, of nodes or elements, smallest and largest tag. */
static PetscErrorCode ParseSectionHeader(EqmGmsh *gmsh, const char *what, size_t bytes_each, PetscInt64 *num_blocks,
                                         PetscInt64 *count)
{
  PetscInt64 unused;

  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the number of blocks", gmsh->ascii ? 8 : 20, num_blocks));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, what, bytes_each, count));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the smallest tag", &unused));
  return EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the largest tag", &unused);
}

/* Dimension and tag of the entity, a third number, and how many follow. */
static PetscErrorCode ParseBlockHeader(EqmGmsh *gmsh, PetscInt64 *dimension, PetscInt64 *third, PetscInt64 *count)
{
  PetscInt64 unused;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the dimension of an entity", dimension));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the tag of an entity", &unused));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the third number of a block", third));
  return EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the length of a block", 2, count);
}

/* Parametric coordinates, which follow the coordinates of a node: one on curves, two on surfaces. */
static PetscErrorCode SkipParameters(EqmGmsh *gmsh, PetscInt64 dimension)
{
  const char *skipped;

  if (gmsh->ascii) {
    EqmSkipLine(gmsh->in);
    return 0;
  }
  return EqmTakeBytes(gmsh->in, 8 * (size_t)PetscMax(0, PetscMin(dimension, 3)), "parametric coordinates", &skipped);
}

static PetscErrorCode ParseNodeBlock(EqmGmsh *gmsh, PetscInt64 *missing)
{
  PetscInt64 dimension, parametric, count, tag;
  PetscReal *x;

  EqmTry(ParseBlockHeader(gmsh, &dimension, &parametric, &count));
  if (count > *missing) return EqmReject(gmsh->in, EQM_ERR_IO, "the blocks have more nodes than the section");
  *missing -= count;
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the tag of a node", &tag));
    if (tag < 0) return EqmReject(gmsh->in, EQM_ERR_IO, "a node has a negative tag");
    EqmTagMapAdd(&gmsh->tags, tag);
  }
  EqmTry(EqmBuilderAddVertices(&gmsh->builder, (size_t)count, &x));
  for (PetscInt64 i = 0; i < count; ++i) {
    if (gmsh->ascii) EqmSkipSpace(gmsh->in, 0);
    EqmTry(EqmGmshReadPoint(gmsh, x + 3 * i));
    if (parametric) EqmTry(SkipParameters(gmsh, dimension));
  }
  return 0;
}

/* EqmGmshParseNodes4 - the section $Nodes of version 4.1. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseNodes4(EqmGmsh *gmsh)
{
  PetscInt64 num_blocks, count;

  EqmTry(ParseSectionHeader(gmsh, "the number of nodes", gmsh->ascii ? 8 : 32, &num_blocks, &count));
  EqmTry(EqmTagMapReserve(&gmsh->tags, (size_t)count));
  for (PetscInt64 b = 0; b < num_blocks; ++b) EqmTry(ParseNodeBlock(gmsh, &count));
  if (count)
    return EqmReject(gmsh->in, EQM_ERR_IO, "the blocks have %lld nodes less than the section", (long long)count);
  return 0;
}

static PetscErrorCode ParseElementBlock(EqmGmsh *gmsh)
{
  PetscInt64 dimension, type, count, tag;
  PetscInt num_nodes;

  EqmTry(ParseBlockHeader(gmsh, &dimension, &type, &count));
  EqmTry(EqmGmshNodesOfType(gmsh, type, &num_nodes));
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the tag of an element", &tag));
    EqmTry(EqmGmshReadElement(gmsh, type, num_nodes, EQM_SCALAR_UINT64));
  }
  return 0;
}

/* EqmGmshParseElements4 - the section $Elements of version 4.1. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseElements4(EqmGmsh *gmsh)
{
  PetscInt64 num_blocks, count;

  EqmTry(ParseSectionHeader(gmsh, "the number of elements", gmsh->ascii ? 4 : 16, &num_blocks, &count));
  for (PetscInt64 b = 0; b < num_blocks; ++b) EqmTry(ParseElementBlock(gmsh));
  return 0;
}
