/* PLY: ASCII and binary of both byte orders, with any elements and properties beside the mesh. */
#include "builder.h"
#include "writers.h"
#include "scalar.h"

#include <string.h>

typedef enum { ROLE_NONE, ROLE_X, ROLE_Y, ROLE_Z, ROLE_CORNERS } Role;

typedef struct {
  EqmScalarType count_type; /* EQM_SCALAR_NONE: one number, not a list */
  EqmScalarType type;
  Role role;
} Property;

#define MAX_PROPERTIES 128 /* of one element; the files of scanners have about twenty */
#define MAX_ELEMENTS   32

typedef struct {
  PetscBool is_vertex, is_face;
  PetscInt64 count;
  const char *position; /* of the header line, for messages */
  PetscInt num_properties;
  Property property[MAX_PROPERTIES];
} Element;

typedef struct {
  PetscBool ascii, big_endian;
  PetscInt num_elements;
  PetscInt64 num_vertices;
  Element element[MAX_ELEMENTS];
} Header;

/* The first line is "ply". Not collective. */
static PetscBool RecognisePly(const char *bytes, size_t length)
{
  return length >= 4 && !memcmp(bytes, "ply", 3) && EqmIsSpace(bytes[3]) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ParseType(EqmInput *in, EqmScalarType *type)
{
  static const struct {
    const char *name;
    EqmScalarType type;
  } known[] = {{"char", EQM_SCALAR_INT8},       {"int8", EQM_SCALAR_INT8},      {"uchar", EQM_SCALAR_UINT8},
               {"uint8", EQM_SCALAR_UINT8},     {"short", EQM_SCALAR_INT16},    {"int16", EQM_SCALAR_INT16},
               {"ushort", EQM_SCALAR_UINT16},   {"uint16", EQM_SCALAR_UINT16},  {"int", EQM_SCALAR_INT32},
               {"int32", EQM_SCALAR_INT32},     {"uint", EQM_SCALAR_UINT32},    {"uint32", EQM_SCALAR_UINT32},
               {"int64", EQM_SCALAR_INT64},     {"uint64", EQM_SCALAR_UINT64},  {"float", EQM_SCALAR_FLOAT32},
               {"float32", EQM_SCALAR_FLOAT32}, {"double", EQM_SCALAR_FLOAT64}, {"float64", EQM_SCALAR_FLOAT64}};

  for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); ++i) {
    if (EqmReadKeyword(in, known[i].name)) {
      *type = known[i].type;
      return 0;
    }
  }
  return EqmReject(in, EQM_ERR_IO,
                   "unknown type of a property; known are char, uchar, short, ushort, int, uint, float, "
                   "double and their names with sizes");
}

static Role RoleOf(const Element *element, PetscBool is_list, const char *name, size_t length)
{
  if (element->is_vertex && !is_list && length == 1 && *name >= 'x' && *name <= 'z') {
    return (Role)(ROLE_X + (*name - 'x'));
  }
  if (element->is_face && is_list &&
      (EqmWordIs(name, length, "vertex_indices") || EqmWordIs(name, length, "vertex_index"))) {
    return ROLE_CORNERS;
  }
  return ROLE_NONE;
}

static PetscErrorCode ParseProperty(EqmInput *in, Header *header)
{
  Element *element = header->num_elements ? &header->element[header->num_elements - 1] : NULL;
  Property *property;
  const char *name;
  size_t length;
  PetscBool is_list;

  if (!element) return EqmReject(in, EQM_ERR_IO, "a property before the first element");
  if (element->num_properties == MAX_PROPERTIES) {
    return EqmReject(in, EQM_ERR_IO, "more than %d properties of one element", MAX_PROPERTIES);
  }
  property = &element->property[element->num_properties++];
  is_list = EqmReadKeyword(in, "list");
  if (is_list) {
    EqmTry(ParseType(in, &property->count_type));
    if (!EqmScalarIsInteger(property->count_type))
      return EqmReject(in, EQM_ERR_IO, "the length of a list must be whole");
  }
  EqmTry(ParseType(in, &property->type));
  length = EqmReadWord(in, &name);
  property->role = RoleOf(element, is_list, name, length);
  if (property->role == ROLE_CORNERS && !EqmScalarIsInteger(property->type)) {
    return EqmRejectAt(in, name, EQM_ERR_IO, "vertex indices must be whole numbers");
  }
  return 0;
}

static PetscErrorCode ParseElement(EqmInput *in, Header *header)
{
  Element *element;
  const char *name;
  size_t length;

  if (header->num_elements == MAX_ELEMENTS) return EqmReject(in, EQM_ERR_IO, "more than %d elements", MAX_ELEMENTS);
  element = &header->element[header->num_elements++];
  element->position = in->cursor;
  length = EqmReadWord(in, &name);
  element->is_vertex = EqmWordIs(name, length, "vertex");
  element->is_face = EqmWordIs(name, length, "face");
  if (!EqmReadInteger(in, &element->count) || element->count < 0) {
    return EqmReject(in, EQM_ERR_IO, "an element needs a name and a number");
  }
  if (element->is_vertex) header->num_vertices = element->count;
  return 0;
}

static PetscErrorCode ParseEncoding(EqmInput *in, Header *header)
{
  header->ascii = EqmReadKeyword(in, "ascii");
  header->big_endian = header->ascii ? PETSC_FALSE : EqmReadKeyword(in, "binary_big_endian");
  if (header->ascii || header->big_endian || EqmReadKeyword(in, "binary_little_endian")) return 0;
  return EqmReject(in, EQM_ERR_IO, "unknown format; known are ascii, binary_little_endian and binary_big_endian");
}

/* The vertex element must come once, with coordinates; the face element must have a list of vertices. */
static PetscErrorCode CheckHeader(EqmInput *in, const Header *header)
{
  PetscInt num_vertex_elements = 0;

  for (PetscInt e = 0; e < header->num_elements; ++e) {
    const Element *element = &header->element[e];
    PetscInt has[ROLE_CORNERS + 1] = {0};

    for (PetscInt p = 0; p < element->num_properties; ++p) ++has[element->property[p].role];
    if (element->is_vertex) {
      ++num_vertex_elements;
      if (has[ROLE_X] != 1 || has[ROLE_Y] != 1 || has[ROLE_Z] != 1) {
        return EqmRejectAt(in, element->position, EQM_ERR_IO, "vertices need the properties x, y and z, once each");
      }
    }
    if (element->is_face && element->count && has[ROLE_CORNERS] != 1) {
      return EqmRejectAt(in, element->position, EQM_ERR_IO, "faces need one list property vertex_indices");
    }
  }
  if (num_vertex_elements != 1) return EqmReject(in, EQM_ERR_IO, "the header needs one element named vertex");
  return 0;
}

static PetscErrorCode ParseHeader(EqmInput *in, Header *header)
{
  PetscBool has_format = PETSC_FALSE;

  if (!EqmReadKeyword(in, "ply")) return EqmReject(in, EQM_ERR_IO, "a PLY file begins with ply");
  for (EqmSkipLine(in); !EqmReadKeyword(in, "end_header"); EqmSkipLine(in)) {
    if (in->cursor == in->end) return EqmReject(in, EQM_ERR_IO, "the header has no end_header: the file is truncated");
    if (EqmReadKeyword(in, "format")) {
      EqmTry(ParseEncoding(in, header));
      has_format = PETSC_TRUE;
    } else if (EqmReadKeyword(in, "element")) {
      EqmTry(ParseElement(in, header));
    } else if (EqmReadKeyword(in, "property")) {
      EqmTry(ParseProperty(in, header));
    } else if (!EqmAtLineEnd(in) && !EqmReadKeyword(in, "comment") && !EqmReadKeyword(in, "obj_info")) {
      return EqmReject(in, EQM_ERR_IO, "unknown line in the header of a PLY file");
    }
  }
  if (!has_format) return EqmReject(in, EQM_ERR_IO, "the header does not say the format");
  EqmTry(CheckHeader(in, header));
  EqmSkipLine(in);
  return 0;
}

/* Bytes that a row of this element takes at least. */
static size_t SmallestRow(const Header *header, const Element *element)
{
  size_t size = 0;

  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const Property *property = &element->property[p];

    size += header->ascii ? 2 : EqmScalarSize(property->count_type ? property->count_type : property->type);
  }
  return size;
}

static PetscErrorCode ReadNumber(EqmInput *in, const Header *header, EqmScalarType type, PetscReal *value)
{
  const char *bytes;

  if (header->ascii) {
    EqmSkipSpace(in, 0);
    return EqmReadReal(in, value) ? 0 : EqmReject(in, EQM_ERR_IO, "a number is missing");
  }
  EqmTry(EqmTakeBytes(in, EqmScalarSize(type), "data", &bytes));
  *value = EqmLoadReal(bytes, type, header->big_endian);
  return 0;
}

static PetscErrorCode ReadWhole(EqmInput *in, const Header *header, EqmScalarType type, PetscInt64 *value)
{
  const char *bytes;

  if (header->ascii) {
    EqmSkipSpace(in, 0);
    return EqmReadInteger(in, value) ? 0 : EqmReject(in, EQM_ERR_IO, "a whole number is missing");
  }
  EqmTry(EqmTakeBytes(in, EqmScalarSize(type), "data", &bytes));
  *value = EqmLoadInteger(bytes, type, header->big_endian);
  return 0;
}

/* A list; its first three entries if they are corners. */
static PetscErrorCode ReadList(EqmInput *in, const Header *header, const Property *property, PetscInt64 *count,
                               PetscInt64 corners[3])
{
  const char *position = in->cursor, *bytes;

  EqmTry(ReadWhole(in, header, property->count_type, count));
  if (*count < 0) return EqmRejectAt(in, position, EQM_ERR_IO, "a list cannot have %lld entries", (long long)*count);
  for (PetscInt64 k = 0; k < *count; ++k) {
    PetscReal unused;

    if (property->role == ROLE_CORNERS && k < 3) {
      EqmTry(ReadWhole(in, header, property->type, &corners[k]));
    } else if (header->ascii) {
      EqmTry(ReadNumber(in, header, property->type, &unused));
    } else { /* the rest in one step */
      if ((size_t)(*count - k) > EqmRemaining(in)) return EqmReject(in, EQM_ERR_IO, "the file ends inside a list");
      return EqmTakeBytes(in, (size_t)(*count - k) * EqmScalarSize(property->type), "list", &bytes);
    }
  }
  return 0;
}

static PetscErrorCode ReadRow(EqmInput *in, const Header *header, const Element *element, EqmBuilder *builder,
                              PetscReal *x)
{
  const char *position = in->cursor;

  if (header->ascii) EqmSkipSpace(in, 0);
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const Property *property = &element->property[p];
    PetscInt64 count, corners[3] = {0, 0, 0};
    PetscReal value;

    if (!property->count_type) {
      EqmTry(ReadNumber(in, header, property->type, &value));
      if (property->role) x[property->role - ROLE_X] = value;
    } else {
      EqmTry(ReadList(in, header, property, &count, corners));
      if (property->role) EqmTry(EqmBuilderAddFace(builder, position, header->num_vertices, count, corners));
    }
  }
  return 0;
}

static PetscErrorCode ParseRows(EqmInput *in, const Header *header, const Element *element, EqmBuilder *builder)
{
  const size_t smallest = SmallestRow(header, element);
  PetscReal *vertices = NULL;

  if (!smallest) return 0; /* rows without properties have no bytes in the file */
  if ((size_t)element->count > (EqmRemaining(in) + 1) / smallest) {
    in->binary = PETSC_FALSE;
    return EqmRejectAt(in, element->position, EQM_ERR_IO,
                       "%lld rows of this element are announced, but the file is too short for them: it is truncated",
                       (long long)element->count);
  }
  if (element->is_vertex) EqmTry(EqmBuilderAddVertices(builder, (size_t)element->count, &vertices));
  for (PetscInt64 i = 0; i < element->count; ++i) {
    EqmTry(ReadRow(in, header, element, builder, vertices ? vertices + 3 * i : NULL));
  }
  return 0;
}

static PetscErrorCode ParseMesh(EqmInput *in, Header *header, EqmBuilder *builder)
{
  EqmTry(ParseHeader(in, header));
  in->binary = header->ascii ? PETSC_FALSE : PETSC_TRUE;
  for (PetscInt e = 0; e < header->num_elements; ++e) {
    EqmTry(ParseRows(in, header, &header->element[e], builder));
  }
  return 0;
}

/* Read a PLY file. See EqmParser. */
static PetscErrorCode ParsePly(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;
  Header *header;
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmTry(PetscCalloc1(1, &header));
  EqmBuilderOpen(&builder, &in);
  code = ParseMesh(&in, header, &builder);
  EqmTry(PetscFree(header));
  return EqmBuilderFinish(&builder, code, mesh);
}

EQM_DEFINE_FORMAT(Ply) = {
    .name = "PLY", .suffixes = "ply", .recognise = RecognisePly, .parse = ParsePly, .write = EqmWritePly};
