/* What the versions of Gmsh's MSH format share: numbers, nodes, elements. */
#include "gmsh.h"

#include <stdio.h>

enum { GMSH_TRIANGLE = 2, GMSH_TETRAHEDRON = 4 /* and between them the quadrilateral */ };

/* EqmGmshReadInteger - the next whole number, text or `type`. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshReadInteger(EqmGmsh *gmsh, EqmScalarType type, const char *what, PetscInt64 *value)
{
  const char *bytes;

  if (gmsh->ascii) {
    EqmSkipSpace(gmsh->in, 0);
    return EqmReadInteger(gmsh->in, value)
               ? 0
               : EqmReject(gmsh->in, EQM_ERR_IO, "%s is missing or not a whole number", what);
  }
  EqmTry(EqmTakeBytes(gmsh->in, EqmScalarSize(type), what, &bytes));
  *value = EqmLoadInteger(bytes, type, gmsh->big_endian);
  return 0;
}

/* EqmGmshReadCount - the number of `what`, which the rest of the file must be able to hold. Not collective. Errors:
   EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshReadCount(EqmGmsh *gmsh, EqmScalarType type, const char *what, size_t bytes_each,
                                PetscInt64 *count)
{
  const char *position = gmsh->in->cursor;

  EqmTry(EqmGmshReadInteger(gmsh, type, what, count));
  if (*count >= 0 && (size_t)*count <= EqmRemaining(gmsh->in) / bytes_each + 1) return 0;
  return EqmRejectAt(gmsh->in, position, EQM_ERR_IO,
                     "%lld is announced as %s, but the file is too short for that: it is truncated or damaged",
                     (long long)*count, what);
}

/* EqmGmshReadTag - the tag of the next node, for which room has been reserved. Not collective. Errors: EQM_ERR_IO
 * (quiet).
 */
PetscErrorCode EqmGmshReadTag(EqmGmsh *gmsh, EqmScalarType type)
{
  PetscInt64 tag;

  EqmTry(EqmGmshReadInteger(gmsh, type, "the tag of a node", &tag));
  if (tag < 0) return EqmReject(gmsh->in, EQM_ERR_IO, "a node has the negative tag %lld", (long long)tag);
  EqmTagMapAdd(&gmsh->tags, tag);
  return 0;
}

/* EqmGmshReadPoint - three coordinates. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmGmshReadPoint(EqmGmsh *gmsh, PetscReal point[3])
{
  const char *bytes;

  if (gmsh->ascii) {
    for (PetscInt k = 0; k < 3; ++k) {
      if (!EqmReadReal(gmsh->in, &point[k])) return EqmReject(gmsh->in, EQM_ERR_IO, "a node needs three coordinates");
    }
    return 0;
  }
  EqmTry(EqmTakeBytes(gmsh->in, 24, "coordinates", &bytes));
  for (PetscInt k = 0; k < 3; ++k) point[k] = EqmLoadReal(bytes + 8 * k, EQM_SCALAR_FLOAT64, gmsh->big_endian);
  return 0;
}

/* EqmGmshCloseNodes - all nodes are read. Not collective. Errors: EQM_ERR_IO (quiet) if two have the same tag. */
PetscErrorCode EqmGmshCloseNodes(EqmGmsh *gmsh)
{
  PetscInt64 repeated;

  EqmTry(EqmTagMapClose(&gmsh->tags, &repeated));
  if (repeated >= 0) return EqmReject(gmsh->in, EQM_ERR_IO, "two nodes have the tag %lld", (long long)repeated);
  gmsh->num_nodes = (PetscInt64)gmsh->builder.num_vertices;
  return 0;
}

/* EqmGmshNodesOfType - nodes of an element of this type. Not collective. Errors: EQM_ERR_IO (quiet) if it is unknown.
 */
PetscErrorCode EqmGmshNodesOfType(EqmGmsh *gmsh, PetscInt64 type, PetscInt *num_nodes)
{
  static const int nodes[] = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                              8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

  if (type < 1 || type >= (PetscInt64)(sizeof(nodes) / sizeof(nodes[0]))) {
    return EqmReject(gmsh->in, EQM_ERR_IO, "unknown element type %lld; save the mesh with elements of first order",
                     (long long)type);
  }
  *num_nodes = nodes[type];
  return 0;
}

/* Dimension of the types that are not kept. */
static PetscInt DimensionOf(PetscInt64 type)
{
  static const int surfaces[] = {9, 10, 16, 20, 21, 22, 23, 24, 25};
  static const int curves[] = {1, 8, 15, 26, 27, 28};

  for (size_t i = 0; i < sizeof(surfaces) / sizeof(surfaces[0]); ++i) {
    if (type == surfaces[i]) return 2;
  }
  for (size_t i = 0; i < sizeof(curves) / sizeof(curves[0]); ++i) {
    if (type == curves[i]) return 1;
  }
  return 3;
}

/* An element names the node of that tag. */
static PetscErrorCode NoteName(EqmGmsh *gmsh, PetscInt64 tag)
{
  if (gmsh->num_named == gmsh->named_capacity) {
    gmsh->named_capacity = PetscMax(1024, gmsh->named_capacity + gmsh->named_capacity / 2);
    EqmTry(PetscRealloc(sizeof(PetscInt64) * (size_t)gmsh->named_capacity, &gmsh->named));
  }
  gmsh->named[gmsh->num_named++] = tag;
  return 0;
}

/* EqmGmshReadElement - the nodes of an element: kept for triangles, quadrilaterals and tetrahedra, skipped for others.
   Not collective. Errors: EQM_ERR_IO (quiet) for a node that is not there. */
PetscErrorCode EqmGmshReadElement(EqmGmsh *gmsh, PetscInt64 type, PetscInt num_nodes, EqmScalarType index)
{
  const char *position = gmsh->in->cursor;
  const PetscBool wanted = type >= GMSH_TRIANGLE && type <= GMSH_TETRAHEDRON ? PETSC_TRUE : PETSC_FALSE;
  PetscInt64 corner[4], tag;
  PetscInt *cell;
  char what[64];

  for (PetscInt k = 0; k < num_nodes; ++k) {
    EqmTry(EqmGmshReadInteger(gmsh, index, "a node of an element", &tag));
    if (wanted && gmsh->names_only) EqmTry(NoteName(gmsh, tag));
    if (!wanted || gmsh->names_only) continue;
    corner[k] = EqmTagMapFind(&gmsh->tags, tag);
    if (corner[k] < 0) {
      return EqmRejectAt(gmsh->in, position, EQM_ERR_IO,
                         "an element names node %lld, which is out of range: no node has this tag", (long long)tag);
    }
  }
  if (gmsh->names_only) return 0;
  if (wanted && type != GMSH_TETRAHEDRON)
    return EqmBuilderAddFace(&gmsh->builder, position, gmsh->num_nodes, num_nodes, corner);
  if (wanted) {
    EqmTry(EqmBuilderAddCells(&gmsh->builder, 4, 1, &cell));
    for (int k = 0; k < 4; ++k) cell[k] = (PetscInt)corner[k];
    return 0;
  }
  if (DimensionOf(type) < 2) return 0;
  snprintf(what, sizeof(what), "an element of type %d with %d nodes", (int)type, (int)num_nodes);
  EqmBuilderNoteOther(&gmsh->builder, DimensionOf(type), position, what);
  return 0;
}
