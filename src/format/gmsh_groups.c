/* Physical groups of Gmsh's MSH format: names, and which entities of version 4 belong to which. */
#include "gmsh.h"
#include "metadata.h"

#include <stdio.h>
#include <string.h>

enum { MOST_NAMES = 10000 }; /* that are kept */

/* EqmGmshParseNames - the section $PhysicalNames, always text: dimension, number, name in quotes. Not collective. A
   line that is not understood ends it. */
PetscErrorCode EqmGmshParseNames(EqmGmsh *gmsh)
{
  EqmInput *const in = gmsh->in;
  PetscInt64 count, dimension, group;

  EqmSkipSpace(in, 0);
  if (!EqmReadInteger(in, &count)) return 0;
  for (PetscInt64 i = 0; i < PetscMin(count, MOST_NAMES); ++i) {
    const char *name, *end;
    char key[40], text[256];

    EqmSkipSpace(in, 0);
    if (!EqmReadInteger(in, &dimension) || !EqmReadInteger(in, &group)) return 0;
    EqmSkipBlanks(in);
    name = in->cursor;
    if (name == in->end || *name != '"') return 0;
    ++name;
    end = memchr(name, '"', (size_t)(in->end - name));
    if (!end) return 0;
    snprintf(key, sizeof(key), EQM_GROUP_KEY, (long long)group);
    snprintf(text, sizeof(text), "%.*s", (int)PetscMin(end - name, (long)sizeof(text) - 1), name);
    if (dimension == 2 || dimension == 3) EqmTry(EqmMetadataAdd(&gmsh->names[dimension - 2], key, text));
    in->cursor = end + 1;
  }
  return 0;
}

/* Move over `count` numbers of a type. */
static PetscErrorCode SkipNumbers(EqmGmsh *gmsh, EqmScalarType type, PetscInt64 count)
{
  const char *skipped;
  PetscReal unused;

  if (!gmsh->ascii) return EqmTakeBytes(gmsh->in, (size_t)count * EqmScalarSize(type), "entity", &skipped);
  for (PetscInt64 i = 0; i < count; ++i) {
    EqmSkipSpace(gmsh->in, 0);
    if (!EqmReadReal(gmsh->in, &unused)) return EqmReject(gmsh->in, EQM_ERR_IO, "a number of an entity is missing");
  }
  return 0;
}

static PetscErrorCode AddEntity(EqmGmsh *gmsh, EqmGmshEntity entity)
{
  if (gmsh->num_entities == gmsh->entity_capacity) {
    gmsh->entity_capacity = PetscMax(16, 2 * gmsh->entity_capacity);
    EqmTry(PetscRealloc(sizeof(EqmGmshEntity) * (size_t)gmsh->entity_capacity, &gmsh->entities));
  }
  gmsh->entities[gmsh->num_entities++] = entity;
  return 0;
}

/* Tag, a point (of points) or a box, physical groups, and (but of points) the entities that bound it. */
static PetscErrorCode ParseEntity(EqmGmsh *gmsh, PetscInt64 dimension)
{
  const PetscInt64 num_reals = dimension || gmsh->version_4_0 ? 6 : 3;
  EqmGmshEntity entity = {.dimension = dimension};
  PetscInt64 count;

  EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "the tag of an entity", &entity.tag));
  EqmTry(SkipNumbers(gmsh, EQM_SCALAR_FLOAT64, num_reals));
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the number of physical groups", 2, &count));
  if (count) {
    EqmTry(EqmGmshReadInteger(gmsh, EQM_SCALAR_INT32, "a physical group", &entity.group));
    EqmTry(SkipNumbers(gmsh, EQM_SCALAR_INT32, count - 1));
    if (dimension >= 2) EqmTry(AddEntity(gmsh, entity));
  }
  if (!dimension) return 0;
  EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the number of bounding entities", 2, &count));
  return SkipNumbers(gmsh, EQM_SCALAR_INT32, count);
}

static PetscErrorCode ParseAll(EqmGmsh *gmsh)
{
  PetscInt64 count[4];

  EqmSkipLine(gmsh->in);
  for (int d = 0; d < 4; ++d) EqmTry(EqmGmshReadCount(gmsh, EQM_SCALAR_UINT64, "the number of entities", 8, &count[d]));
  for (PetscInt64 d = 0; d < 4; ++d) {
    for (PetscInt64 i = 0; i < count[d]; ++i) EqmTry(ParseEntity(gmsh, d));
  }
  return 0;
}

/* EqmGmshParseEntities - the section $Entities of versions 4.1 and 4.0. Not collective. The mesh is complete without
   it: at what is not understood the rest is left. */
PetscErrorCode EqmGmshParseEntities(EqmGmsh *gmsh)
{
  const char *const start = gmsh->in->cursor;
  const PetscErrorCode code = ParseAll(gmsh);

  gmsh->in->cursor = start;
  return code == EQM_ERR_IO ? 0 : code;
}

/* EqmGmshGroupOf - the physical group of an entity, 0 if it has none. Not collective. */
PetscInt64 EqmGmshGroupOf(const EqmGmsh *gmsh, PetscInt64 dimension, PetscInt64 tag)
{
  for (PetscInt64 k = 0; k < gmsh->num_entities; ++k) {
    const EqmGmshEntity *const entity = &gmsh->entities[k];

    if (entity->dimension == dimension && entity->tag == tag) return entity->group;
  }
  return 0;
}
