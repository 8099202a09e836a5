/* Rows of nodes and elements of Gmsh's MSH format, text or bytes, of a whole file or of a part. */
#include "gmsh.h"

/* What follows the coordinates in $ParametricNodes: dimension and tag of the entity that the node lies on, one
   parameter on a curve, two on a surface. */
static PetscErrorCode SkipParameters2(EqmGmsh *gmsh)
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

/* Parametric coordinates, which follow the coordinates of a node: one on curves, two on surfaces. */
static PetscErrorCode SkipParameters4(EqmGmsh *gmsh, PetscInt64 dimension)
{
  const char *skipped;

  if (gmsh->ascii) {
    EqmSkipLine(gmsh->in);
    return 0;
  }
  return EqmTakeBytes(gmsh->in, 8 * (size_t)PetscMax(0, PetscMin(dimension, 3)), "parametric coordinates", &skipped);
}

static PetscErrorCode ReadTags(EqmGmsh *gmsh, PetscInt64 count)
{
  EqmTry(EqmTagMapReserve(&gmsh->tags, gmsh->tags.count + (size_t)count));
  for (PetscInt64 i = 0; i < count; ++i) EqmTry(EqmGmshReadTag(gmsh, EQM_SCALAR_UINT64));
  return 0;
}

/* Points, each behind its tag in versions 2 and 4.0. */
static PetscErrorCode ReadPoints(EqmGmsh *gmsh, const EqmGmshRun *run, PetscInt64 count)
{
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(&gmsh->builder, (size_t)count, &x));
  if (run->kind == EQM_GMSH_NODES) EqmTry(EqmTagMapReserve(&gmsh->tags, gmsh->tags.count + (size_t)count));
  for (PetscInt64 i = 0; i < count; ++i) {
    if (run->kind == EQM_GMSH_NODES) EqmTry(EqmGmshReadTag(gmsh, EQM_SCALAR_INT32));
    if (gmsh->ascii && gmsh->version == 4) EqmSkipSpace(gmsh->in, 0);
    EqmTry(EqmGmshReadPoint(gmsh, x + 3 * i));
    if (run->parametric && gmsh->version == 2) EqmTry(SkipParameters2(gmsh));
    if (run->parametric && gmsh->version == 4) EqmTry(SkipParameters4(gmsh, run->dimension));
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

/* Of a block of version 2: number, tags, nodes. */
static PetscErrorCode ReadElements2(EqmGmsh *gmsh, const EqmGmshRun *run, PetscInt64 count)
{
  PetscInt num_nodes;
  const char *tags;

  EqmTry(EqmGmshNodesOfType(gmsh, run->type, &num_nodes));
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmTakeBytes(gmsh->in, 4 * (1 + (size_t)run->num_tags), "tags of an element", &tags));
    EqmBuilderSetGroup(&gmsh->builder,
                       run->num_tags ? EqmLoadInteger(tags + 4, EQM_SCALAR_INT32, gmsh->big_endian) : 0);
    EqmTry(EqmGmshReadElement(gmsh, run->type, num_nodes, EQM_SCALAR_INT32));
  }
  return 0;
}

/* Of a block of version 4: tag, nodes. */
static PetscErrorCode ReadElements4(EqmGmsh *gmsh, const EqmGmshRun *run, PetscInt64 count)
{
  const EqmScalarType index = gmsh->version_4_0 ? EQM_SCALAR_INT32 : EQM_SCALAR_UINT64;
  PetscInt64 tag;
  PetscInt num_nodes;

  EqmBuilderSetGroup(&gmsh->builder, run->group);
  EqmTry(EqmGmshNodesOfType(gmsh, run->type, &num_nodes));
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmTry(EqmGmshReadInteger(gmsh, index, "the tag of an element", &tag));
    EqmTry(EqmGmshReadElement(gmsh, run->type, num_nodes, index));
  }
  return 0;
}

/* EqmGmshReadRows - the next `count` rows of a run. Not collective. Errors: EQM_ERR_IO, EQM_ERR_MESH (quiet). */
PetscErrorCode EqmGmshReadRows(EqmGmsh *gmsh, const EqmGmshRun *run, PetscInt64 count)
{
  if (run->kind == EQM_GMSH_TAGS) return ReadTags(gmsh, count);
  if (run->kind != EQM_GMSH_ELEMENTS) return ReadPoints(gmsh, run, count);
  if (gmsh->version == 4) return ReadElements4(gmsh, run, count);
  if (!gmsh->ascii) return ReadElements2(gmsh, run, count);
  for (PetscInt64 i = 0; i < count; ++i) EqmTry(ParseAsciiElement(gmsh));
  return 0;
}

PetscBool EqmGmshHasRoom(const EqmPartFile *file, PetscInt64 at, PetscInt64 bytes_each, PetscInt64 count)
{
  return count >= 0 && count <= (file->length - at) / bytes_each + 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode EqmGmshAddRun(EqmGmshSurvey *survey, const EqmGmshRun *run)
{
  const PetscInt64 num = survey->num_runs;

  if (!(num & (num - 1))) EqmTry(PetscRealloc(sizeof(EqmGmshRun) * (size_t)PetscMax(1, 2 * num), &survey->runs));
  survey->runs[survey->num_runs++] = *run;
  return 0;
}
