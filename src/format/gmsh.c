/* Gmsh's MSH, versions 2.2 and 4.1, ASCII and binary: header, sections, and what both versions share. All nodes are
   kept, in file order; tetrahedra are the cells if there are any, otherwise triangles. */
#define _GNU_SOURCE
#include "gmsh.h"
#include "format.h"

#include <stdio.h>
#include <string.h>

/* EqmRecogniseGmsh - a section $MeshFormat (or $Comments before it). Not collective. */
PetscBool EqmRecogniseGmsh(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipSpace(&in, 0);
  return EqmReadKeyword(&in, "$MeshFormat") || EqmReadKeyword(&in, "$Comments") ? PETSC_TRUE : PETSC_FALSE;
}

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

/* Dimension of the types that are neither triangle nor tetrahedron of first order. */
static PetscInt DimensionOf(PetscInt64 type)
{
  static const int surfaces[] = {3, 9, 10, 16, 20, 21, 22, 23, 24, 25};
  static const int curves[] = {1, 8, 15, 26, 27, 28};

  for (size_t i = 0; i < sizeof(surfaces) / sizeof(surfaces[0]); ++i) {
    if (type == surfaces[i]) return 2;
  }
  for (size_t i = 0; i < sizeof(curves) / sizeof(curves[0]); ++i) {
    if (type == curves[i]) return 1;
  }
  return 3;
}

/* EqmGmshReadElement - the nodes of an element: kept for triangles and tetrahedra, passed over for others. Not
   collective. Errors: EQM_ERR_IO (quiet) for a node that is not there. */
PetscErrorCode EqmGmshReadElement(EqmGmsh *gmsh, PetscInt64 type, PetscInt num_nodes, EqmScalarType index)
{
  const char *position = gmsh->in->cursor;
  const PetscBool wanted = type == 2 || type == 4 ? PETSC_TRUE : PETSC_FALSE;
  PetscInt *cell = NULL;
  char what[64];

  if (wanted) EqmTry(EqmBuilderAddCells(&gmsh->builder, num_nodes, 1, &cell));
  for (PetscInt k = 0; k < num_nodes; ++k) {
    PetscInt64 tag;

    EqmTry(EqmGmshReadInteger(gmsh, index, "a node of an element", &tag));
    if (!wanted) continue;
    cell[k] = EqmTagMapFind(&gmsh->tags, tag);
    if (cell[k] < 0) {
      return EqmRejectAt(gmsh->in, position, EQM_ERR_IO,
                         "an element names node %lld, which is out of range: no node has this tag", (long long)tag);
    }
  }
  if (wanted || DimensionOf(type) < 2) return 0;
  snprintf(what, sizeof(what), "an element of type %d with %d nodes", (int)type, (int)num_nodes);
  EqmBuilderNoteOther(&gmsh->builder, DimensionOf(type), position, what);
  return 0;
}

static PetscErrorCode ParseFormat(EqmGmsh *gmsh, PetscInt *version)
{
  EqmInput *in = gmsh->in;
  PetscReal number;
  PetscInt64 binary, size;

  EqmSkipLine(in);
  if (!EqmReadReal(in, &number) || !EqmReadInteger(in, &binary) || !EqmReadInteger(in, &size)) {
    return EqmReject(in, EQM_ERR_IO, "a version, a file type and a data size are missing");
  }
  *version = number == 4.1 ? 4 : number >= 2 && number < 3 ? 2 : 0;
  if (!*version)
    return EqmReject(in, EQM_ERR_IO, "MSH version %g is not supported; save as 4.1 or 2.2", (double)number);
  if (size != 8) return EqmReject(in, EQM_ERR_IO, "a data size of %lld is not supported; 8 is", (long long)size);
  gmsh->ascii = binary ? PETSC_FALSE : PETSC_TRUE;
  EqmSkipLine(in);
  if (binary) { /* the number 1 shows the byte order */
    const char *one;

    in->binary = PETSC_TRUE;
    EqmTry(EqmTakeBytes(in, 4, "byte order", &one));
    gmsh->big_endian = EqmLoadInteger(one, EQM_SCALAR_INT32, PETSC_TRUE) == 1 ? PETSC_TRUE : PETSC_FALSE;
    if (!gmsh->big_endian && EqmLoadInteger(one, EQM_SCALAR_INT32, PETSC_FALSE) != 1) {
      return EqmReject(in, EQM_ERR_IO, "the byte order mark is damaged");
    }
  }
  return 0;
}

/* Move behind the line $EndNAME that closes a section. */
static PetscErrorCode SkipToEnd(EqmInput *in, const char *name, size_t length)
{
  char closing[96];
  const char *found;

  snprintf(closing, sizeof(closing), "$End%.*s", (int)PetscMin(length, sizeof(closing) - 5), name);
  found = memmem(in->cursor, EqmRemaining(in), closing, strlen(closing));
  if (!found) return EqmReject(in, EQM_ERR_IO, "%s is missing: the file is truncated", closing);
  in->cursor = found;
  EqmSkipLine(in);
  return 0;
}

static PetscErrorCode ParseNodes(EqmGmsh *gmsh, PetscInt version)
{
  if (gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "a second section $Nodes");
  gmsh->has_nodes = PETSC_TRUE;
  EqmSkipLine(gmsh->in);
  EqmTry(version == 2 ? EqmGmshParseNodes2(gmsh) : EqmGmshParseNodes4(gmsh));
  return EqmGmshCloseNodes(gmsh);
}

static PetscErrorCode ParseElements(EqmGmsh *gmsh, PetscInt version)
{
  if (!gmsh->has_nodes) return EqmReject(gmsh->in, EQM_ERR_IO, "the section $Elements comes before the section $Nodes");
  EqmSkipLine(gmsh->in);
  return version == 2 ? EqmGmshParseElements2(gmsh) : EqmGmshParseElements4(gmsh);
}

static PetscErrorCode ParseSections(EqmGmsh *gmsh)
{
  EqmInput *in = gmsh->in;
  PetscInt version = 0;

  for (EqmSkipSpace(in, 0); in->cursor < in->end; EqmSkipSpace(in, 0)) {
    const char *word;
    size_t length = EqmReadWord(in, &word);

    if (*word != '$')
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section must begin here, with a $: the file is damaged");
    if (EqmWordIs(word, length, "$MeshFormat")) {
      EqmTry(ParseFormat(gmsh, &version));
    } else if (version && EqmWordIs(word, length, "$Nodes")) {
      EqmTry(ParseNodes(gmsh, version));
    } else if (version && EqmWordIs(word, length, "$Elements")) {
      EqmTry(ParseElements(gmsh, version));
    } else if (!version && !EqmWordIs(word, length, "$Comments")) {
      return EqmRejectAt(in, word, EQM_ERR_IO, "a section before $MeshFormat");
    }
    EqmTry(SkipToEnd(in, word + 1, length - 1));
  }
  if (gmsh->has_nodes) return 0;
  return EqmReject(in, EQM_ERR_IO, "the file has no section $Nodes: it is truncated or not a mesh");
}

/* EqmParseGmsh - read an MSH file. See EqmParser. */
PetscErrorCode EqmParseGmsh(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmGmsh gmsh = {0};
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  gmsh.in = &in;
  EqmBuilderOpen(&gmsh.builder, &in);
  code = ParseSections(&gmsh);
  EqmTry(EqmTagMapReset(&gmsh.tags));
  return EqmBuilderFinish(&gmsh.builder, code, mesh);
}

/* A field as $NodeData or $ElementData. Gmsh knows 1, 3 and 9 numbers a place; what is missing is zero. */
static void PrintField(EqmAtomicFile *file, const EqmField *field, PetscInt count)
{
  const char *const section = field->on_cells ? "ElementData" : "NodeData";
  const PetscInt width = field->width == 1 ? 1 : field->width <= 3 ? 3 : 9;

  if (field->width > 9) return;
  EqmAtomicPrint(file, "$%s\n1\n\"%s\"\n1\n0\n3\n0\n%d\n%lld\n", section, field->name, (int)width, (long long)count);
  for (PetscInt i = 0; i < count; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, field->width, field->values + (size_t)field->width * (size_t)i, ' ');
    for (PetscInt k = field->width; k < width; ++k) EqmAtomicWrite(file, " 0", 2);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$End%s\n", section);
}

/* EqmWriteGmsh - write an ASCII file of version 2.2, which every program reads. See EqmWriter. */
PetscErrorCode EqmWriteGmsh(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields,
                            char *error, size_t error_length)
{
  const PetscInt size = mesh->cell_size;

  EqmAtomicPrint(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%lld\n", (long long)mesh->num_vertices);
  for (PetscInt i = 0; i < mesh->num_vertices; ++i) {
    EqmAtomicPrint(file, "%lld ", (long long)i + 1);
    EqmAtomicPrintReals(file, 3, mesh->vertices + 3 * (size_t)i, ' ');
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndNodes\n$Elements\n%lld\n", (long long)mesh->num_cells);
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    EqmAtomicPrint(file, "%lld %d 2 0 1", (long long)i + 1, size == 3 ? 2 : 4);
    for (PetscInt k = 0; k < size; ++k)
      EqmAtomicPrint(file, " %lld", (long long)mesh->cells[(size_t)size * (size_t)i + (size_t)k] + 1);
    EqmAtomicWrite(file, "\n", 1);
  }
  EqmAtomicPrint(file, "$EndElements\n");
  for (PetscInt f = 0; f < num_fields; ++f) {
    PrintField(file, &fields[f], fields[f].on_cells ? mesh->num_cells : mesh->num_vertices);
  }
  return 0;
}
