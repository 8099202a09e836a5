/* Nodes and elements of MSH 4.1 and 4.0: blocks, one per entity of the geometry. In 4.0 the tags of nodes and elements
   are of 32 bits, each node has its tag before its coordinates, and the header does not say the range of the tags. */
#include "gmsh.h"

/* Number of blocks, of nodes or elements, smallest and largest tag. */
static PetscErrorCode ParseSectionHeader(EqmGmsh *gmsh, const char *what, size_t bytes_each, PetscInt64 *num_blocks,
                                         PetscInt64 *count)
{
  PetscInt64 unused;

  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the number of blocks", gmsh->ascii ? 8 : 20, num_blocks));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, what, bytes_each, count));
  if (gmsh->version_4_0) return 0;
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the smallest tag", &unused));
  return EqmGmshReadInteger(gmsh, EQM_SCALAR_UINT64, "the largest tag", &unused);
}

/* Dimension and tag of the entity (in 4.0: tag and dimension), a third number, and how many follow. */
static PetscErrorCode ParseBlockHeader(EqmGmsh *gmsh, PetscInt64 *dimension, PetscInt64 *entity, PetscInt64 *third,
                                       PetscInt64 *count)
{
  PetscInt64 first;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the dimension of an entity", dimension));
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the tag of an entity", entity));
  if (gmsh->version_4_0) { /* the tag comes first */
    first = *dimension;
    *dimension = *entity;
    *entity = first;
  }
  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the third number of a block", third));
  return EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the length of a block", 2, count);
}

static PetscErrorCode ParseNodeBlock(EqmGmsh *gmsh, PetscInt64 *missing)
{
  EqmGmshRun run = {.kind = gmsh->version_4_0 ? EQM_GMSH_NODES : EQM_GMSH_POINTS};
  PetscInt64 unused;

  EqmTry(ParseBlockHeader(gmsh, &run.dimension, &unused, &run.parametric, &run.count));
  if (run.count > *missing) return EqmReject(gmsh->in, EQM_ERR_IO, "the blocks have more nodes than the section");
  *missing -= run.count;
  if (!gmsh->version_4_0) EqmTry(EqmGmshReadRows(gmsh, &(EqmGmshRun){.kind = EQM_GMSH_TAGS}, run.count));
  return EqmGmshReadRows(gmsh, &run, run.count);
}

/* EqmGmshParseNodes4 - the section $Nodes of versions 4.1 and 4.0. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseNodes4(EqmGmsh *gmsh)
{
  PetscInt64 num_blocks, count;

  EqmTry(ParseSectionHeader(gmsh, "the number of nodes", gmsh->ascii ? 8 : 28, &num_blocks, &count));
  EqmTry(EqmTagMapReserve(&gmsh->tags, (size_t)count));
  for (PetscInt64 b = 0; b < num_blocks; ++b) EqmTry(ParseNodeBlock(gmsh, &count));
  if (count)
    return EqmReject(gmsh->in, EQM_ERR_IO, "the blocks have %lld nodes less than the section", (long long)count);
  return 0;
}

static PetscErrorCode ParseElementBlock(EqmGmsh *gmsh)
{
  EqmGmshRun run = {.kind = EQM_GMSH_ELEMENTS};
  PetscInt64 entity;

  EqmTry(ParseBlockHeader(gmsh, &run.dimension, &entity, &run.type, &run.count));
  run.group = EqmGmshGroupOf(gmsh, run.dimension, entity);
  return EqmGmshReadRows(gmsh, &run, run.count);
}

/* EqmGmshParseElements4 - the section $Elements of versions 4.1 and 4.0. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshParseElements4(EqmGmsh *gmsh)
{
  PetscInt64 num_blocks, count;

  EqmTry(ParseSectionHeader(gmsh, "the number of elements", gmsh->ascii ? 4 : 8, &num_blocks, &count));
  for (PetscInt64 b = 0; b < num_blocks; ++b) EqmTry(ParseElementBlock(gmsh));
  return 0;
}
