/* PLY: ASCII and binary of both byte orders, with any elements and properties beside the mesh. */
#include "builder.h"
#include "writers.h"
#include "scalar.h"

#include <string.h>

typedef enum {
  ROLE_NONE,
  ROLE_X,
  ROLE_Y,
  ROLE_Z,
  ROLE_S, /* texture coordinates of a vertex */
  ROLE_T,
  ROLE_CORNERS,
  ROLE_TEXTURE, /* of the corners of a face, two numbers each */
  NUM_ROLES
} Role;

typedef struct {
  EqmScalarType count_type; /* EQM_SCALAR_NONE: one number, not a list */
  EqmScalarType type;
  Role role;
} Property;

#define MAX_PROPERTIES 128 /* of one element; the files of scanners have about twenty */
#define MAX_ELEMENTS   32

typedef struct {
  PetscBool is_vertex, is_face, is_strips, has_texture;
  PetscInt64 count;
  const char *position; /* of the header line, for messages */
  PetscInt num_properties;
  Property property[MAX_PROPERTIES];
} Element;

typedef struct {
  PetscBool ascii, big_endian;
  PetscInt num_elements;
  PetscInt64 num_vertices;
  PetscBool textured; /* vertices have texture coordinates */
  Element element[MAX_ELEMENTS];
} Header;

/* What the entries of lists become, in arrays that grow. */
typedef struct {
  PetscInt64 num_corners, corner_capacity, num_reals, real_capacity;
  PetscInt64 *corners;
  PetscReal *reals;
} Lists;

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
  static const char *const s_names[] = {"s", "u", "texture_u", "texture_s"}, *const t_names[] = {"t", "v", "texture_v",
                                                                                                 "texture_t"};

  if (element->is_vertex && !is_list) {
    if (length == 1 && *name >= 'x' && *name <= 'z') return (Role)(ROLE_X + (*name - 'x'));
    for (int i = 0; i < 4; ++i) {
      if (EqmWordIs(name, length, s_names[i])) return ROLE_S;
      if (EqmWordIs(name, length, t_names[i])) return ROLE_T;
    }
  }
  if ((element->is_face || element->is_strips) && is_list) {
    if (EqmWordIs(name, length, "vertex_indices") || EqmWordIs(name, length, "vertex_index")) return ROLE_CORNERS;
    if (element->is_face && EqmWordIs(name, length, "texcoord")) return ROLE_TEXTURE;
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
  element->is_strips = EqmWordIs(name, length, "tristrips");
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
static PetscErrorCode CheckHeader(EqmInput *in, Header *header)
{
  PetscInt num_vertex_elements = 0;

  for (PetscInt e = 0; e < header->num_elements; ++e) {
    Element *element = &header->element[e];
    PetscInt has[NUM_ROLES] = {0};

    for (PetscInt p = 0; p < element->num_properties; ++p) ++has[element->property[p].role];
    if (element->is_vertex) {
      ++num_vertex_elements;
      if (has[ROLE_X] != 1 || has[ROLE_Y] != 1 || has[ROLE_Z] != 1) {
        return EqmRejectAt(in, element->position, EQM_ERR_IO, "vertices need the properties x, y and z, once each");
      }
    }
    if (element->is_vertex) header->textured = has[ROLE_S] == 1 && has[ROLE_T] == 1 ? PETSC_TRUE : PETSC_FALSE;
    if ((element->is_face || element->is_strips) && element->count && has[ROLE_CORNERS] != 1) {
      return EqmRejectAt(in, element->position, EQM_ERR_IO, "faces need one list property vertex_indices");
    }
    element->has_texture = has[ROLE_TEXTURE] == 1 ? PETSC_TRUE : PETSC_FALSE;
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

static PetscErrorCode GrowList(size_t entry_bytes, PetscInt64 count, PetscInt64 *capacity, void *array)
{
  if (count < *capacity) return 0;
  *capacity = PetscMax(16, 2 * *capacity);
  return PetscRealloc((size_t)*capacity * entry_bytes, (void **)array);
}

/* A list: corners and texture coordinates are kept, others skipped. */
static PetscErrorCode ReadList(EqmInput *in, const Header *header, const Property *property, Lists *lists)
{
  const char *position = in->cursor, *bytes;
  PetscInt64 count;

  EqmTry(ReadWhole(in, header, property->count_type, &count));
  if (count < 0) return EqmRejectAt(in, position, EQM_ERR_IO, "a list cannot have %lld entries", (long long)count);
  if (property->role == ROLE_NONE && !header->ascii) { /* in one step */
    if ((size_t)count > EqmRemaining(in)) return EqmReject(in, EQM_ERR_IO, "the file ends inside a list");
    return EqmTakeBytes(in, (size_t)count * EqmScalarSize(property->type), "list", &bytes);
  }
  for (PetscInt64 k = 0; k < count; ++k) {
    PetscReal unused;

    if (property->role == ROLE_CORNERS) {
      EqmTry(GrowList(sizeof(PetscInt64), lists->num_corners, &lists->corner_capacity, &lists->corners));
      EqmTry(ReadWhole(in, header, property->type, &lists->corners[lists->num_corners++]));
    } else if (property->role == ROLE_TEXTURE) {
      EqmTry(GrowList(sizeof(PetscReal), lists->num_reals, &lists->real_capacity, &lists->reals));
      EqmTry(ReadNumber(in, header, property->type, &lists->reals[lists->num_reals++]));
    } else {
      EqmTry(ReadNumber(in, header, property->type, &unused));
    }
  }
  return 0;
}

/* The texture point of a corner: its own, or that of its vertex, or none. */
static PetscErrorCode AddFace(const Header *header, const Element *element, const char *position, const Lists *lists,
                              EqmBuilder *builder)
{
  const PetscBool own = element->has_texture && lists->num_corners > 2 && lists->num_reals == 2 * lists->num_corners
                            ? PETSC_TRUE
                            : PETSC_FALSE;
  PetscInt64 first = (PetscInt64)builder->num_texture_points;
  PetscReal *uv;

  if (element->is_strips)
    return EqmBuilderAddStrip(builder, position, header->num_vertices, lists->num_corners, lists->corners);
  if (own) {
    EqmTry(EqmBuilderAddTexturePoints(builder, (size_t)lists->num_corners, &uv));
    for (PetscInt64 k = 0; k < lists->num_reals; ++k) uv[k] = lists->reals[k];
  }
  EqmBuilderStartFace(builder);
  for (PetscInt64 k = 0; k < lists->num_corners; ++k) {
    const PetscInt64 vertex = lists->corners[k];

    EqmTry(EqmBuilderAddCorner(builder, vertex, own ? first + k : header->textured ? vertex : -1));
  }
  return EqmBuilderEndFace(builder, position, header->num_vertices);
}

/* One vertex, whose coordinates go to x and (where there are some) uv, or one face, or a row to be skipped. */
static PetscErrorCode ReadRow(EqmInput *in, const Header *header, const Element *element, EqmBuilder *builder,
                              PetscReal *x, PetscReal *uv, Lists *lists)
{
  const char *position = in->cursor;

  if (header->ascii) EqmSkipSpace(in, 0);
  lists->num_corners = lists->num_reals = 0;
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const Property *property = &element->property[p];
    PetscReal value;

    if (property->count_type) {
      EqmTry(ReadList(in, header, property, lists));
      continue;
    }
    EqmTry(ReadNumber(in, header, property->type, &value));
    if (property->role >= ROLE_X && property->role <= ROLE_Z) x[property->role - ROLE_X] = value;
    if (property->role >= ROLE_S && property->role <= ROLE_T && uv) uv[property->role - ROLE_S] = value;
  }
  return element->is_face || element->is_strips ? AddFace(header, element, position, lists, builder) : 0;
}

static PetscErrorCode ParseRows(EqmInput *in, const Header *header, const Element *element, EqmBuilder *builder)
{
  const size_t smallest = SmallestRow(header, element);
  PetscReal *vertices = NULL, *uv = NULL;
  Lists lists = {0};
  PetscErrorCode code = 0;

  if (!smallest) return 0; /* rows without properties have no bytes in the file */
  if ((size_t)element->count > (EqmRemaining(in) + 1) / smallest) {
    in->binary = PETSC_FALSE;
    return EqmRejectAt(in, element->position, EQM_ERR_IO,
                       "%lld rows of this element are announced, but the file is too short for them: it is truncated",
                       (long long)element->count);
  }
  if (element->is_vertex) EqmTry(EqmBuilderAddVertices(builder, (size_t)element->count, &vertices));
  if (element->is_vertex && header->textured) EqmTry(EqmBuilderAddTexturePoints(builder, (size_t)element->count, &uv));
  for (PetscInt64 i = 0; i < element->count && !code; ++i)
    code = ReadRow(in, header, element, builder, vertices ? vertices + 3 * i : NULL, uv ? uv + 2 * i : NULL, &lists);
  EqmTry(PetscFree(lists.corners));
  EqmTry(PetscFree(lists.reals));
  return code;
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

EQM_DEFINE_FORMAT(Ply) = {.name = "PLY",
                          .suffixes = "ply",
                          .recognise = RecognisePly,
                          .parse = ParsePly,
                          .write = EqmWritePly,
                          .writes_texture = PETSC_TRUE};
