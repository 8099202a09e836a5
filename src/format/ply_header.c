#include "ply.h"

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

static EqmPlyRole RoleOf(const EqmPlyElement *element, PetscBool is_list, const char *name, size_t length)
{
  static const char *const s_names[] = {"s", "u", "texture_u", "texture_s"}, *const t_names[] = {"t", "v", "texture_v",
                                                                                                 "texture_t"};

  if (element->is_vertex && !is_list) {
    if (length == 1 && *name >= 'x' && *name <= 'z') return (EqmPlyRole)(EQM_PLY_ROLE_X + (*name - 'x'));
    for (int i = 0; i < 4; ++i) {
      if (EqmWordIs(name, length, s_names[i])) return EQM_PLY_ROLE_S;
      if (EqmWordIs(name, length, t_names[i])) return EQM_PLY_ROLE_T;
    }
  }
  if ((element->is_face || element->is_strips) && is_list) {
    if (EqmWordIs(name, length, "vertex_indices") || EqmWordIs(name, length, "vertex_index"))
      return EQM_PLY_ROLE_CORNERS;
    if (element->is_face && EqmWordIs(name, length, "texcoord")) return EQM_PLY_ROLE_TEXTURE;
  }
  return EQM_PLY_ROLE_NONE;
}

static PetscErrorCode ParseProperty(EqmInput *in, EqmPlyHeader *header)
{
  EqmPlyElement *element = header->num_elements ? &header->element[header->num_elements - 1] : NULL;
  EqmPlyProperty *property;
  const char *name;
  size_t length;
  PetscBool is_list;

  if (!element) return EqmReject(in, EQM_ERR_IO, "a property before the first element");
  if (element->num_properties == EQM_PLY_MAX_PROPERTIES) {
    return EqmReject(in, EQM_ERR_IO, "more than %d properties of one element", EQM_PLY_MAX_PROPERTIES);
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
  property->name = name;
  property->name_length = length;
  if (property->role == EQM_PLY_ROLE_CORNERS && !EqmScalarIsInteger(property->type)) {
    return EqmRejectAt(in, name, EQM_ERR_IO, "vertex indices must be whole numbers");
  }
  return 0;
}

static PetscErrorCode ParseElement(EqmInput *in, EqmPlyHeader *header)
{
  EqmPlyElement *element;
  const char *name;
  size_t length;

  if (header->num_elements == EQM_PLY_MAX_ELEMENTS)
    return EqmReject(in, EQM_ERR_IO, "more than %d elements", EQM_PLY_MAX_ELEMENTS);
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

static PetscErrorCode ParseEncoding(EqmInput *in, EqmPlyHeader *header)
{
  header->ascii = EqmReadKeyword(in, "ascii");
  header->big_endian = header->ascii ? PETSC_FALSE : EqmReadKeyword(in, "binary_big_endian");
  if (header->ascii || header->big_endian || EqmReadKeyword(in, "binary_little_endian")) return 0;
  return EqmReject(in, EQM_ERR_IO, "unknown format; known are ascii, binary_little_endian and binary_big_endian");
}

/* The vertex element must come once, with coordinates; the face element must have a list of vertices. */
static PetscErrorCode CheckHeader(EqmInput *in, EqmPlyHeader *header)
{
  PetscInt num_vertex_elements = 0;

  for (PetscInt e = 0; e < header->num_elements; ++e) {
    EqmPlyElement *element = &header->element[e];
    PetscInt has[EQM_PLY_NUM_ROLES] = {0};

    for (PetscInt p = 0; p < element->num_properties; ++p) ++has[element->property[p].role];
    if (element->is_vertex) {
      ++num_vertex_elements;
      if (has[EQM_PLY_ROLE_X] != 1 || has[EQM_PLY_ROLE_Y] != 1 || has[EQM_PLY_ROLE_Z] != 1) {
        return EqmRejectAt(in, element->position, EQM_ERR_IO, "vertices need the properties x, y and z, once each");
      }
    }
    if (element->is_vertex) /* s and t as floats, then u and v as doubles: the latter count */
      header->textured =
          has[EQM_PLY_ROLE_S] > 0 && has[EQM_PLY_ROLE_S] == has[EQM_PLY_ROLE_T] ? PETSC_TRUE : PETSC_FALSE;
    if ((element->is_face || element->is_strips) && element->count && has[EQM_PLY_ROLE_CORNERS] != 1) {
      return EqmRejectAt(in, element->position, EQM_ERR_IO, "faces need one list property vertex_indices");
    }
    element->has_texture = has[EQM_PLY_ROLE_TEXTURE] == 1 ? PETSC_TRUE : PETSC_FALSE;
  }
  if (num_vertex_elements != 1) return EqmReject(in, EQM_ERR_IO, "the header needs one element named vertex");
  return 0;
}

/* EqmPlyParseHeader - read from "ply" to "end_header". Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmPlyParseHeader(EqmInput *in, EqmPlyHeader *header)
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
