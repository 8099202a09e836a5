/* Rows of PLY files, text or bytes: vertices, faces, strips. */
#include "ply.h"

/* What the entries of lists become, in arrays that grow. */
typedef struct {
  PetscInt64 num_corners, corner_capacity, num_reals, real_capacity;
  PetscInt64 *corners;
  PetscReal *reals;
} Lists;

/* EqmPlySmallestRow - bytes that a row of this element takes at least. Not collective. */
size_t EqmPlySmallestRow(const EqmPlyHeader *header, const EqmPlyElement *element)
{
  size_t size = 0;

  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const EqmPlyProperty *property = &element->property[p];

    size += header->ascii ? 2 : EqmScalarSize(property->count_type ? property->count_type : property->type);
  }
  return size;
}

static PetscErrorCode ReadNumber(EqmInput *in, const EqmPlyHeader *header, EqmScalarType type, PetscReal *value)
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

static PetscErrorCode ReadWhole(EqmInput *in, const EqmPlyHeader *header, EqmScalarType type, PetscInt64 *value)
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
static PetscErrorCode ReadList(EqmInput *in, const EqmPlyHeader *header, const EqmPlyProperty *property, Lists *lists)
{
  const char *position = in->cursor, *bytes;
  PetscInt64 count;

  EqmTry(ReadWhole(in, header, property->count_type, &count));
  if (count < 0) return EqmRejectAt(in, position, EQM_ERR_IO, "a list cannot have %lld entries", (long long)count);
  if (property->role == EQM_PLY_ROLE_NONE && !header->ascii) { /* in one step */
    if ((size_t)count > EqmRemaining(in)) return EqmReject(in, EQM_ERR_IO, "the file ends inside a list");
    return EqmTakeBytes(in, (size_t)count * EqmScalarSize(property->type), "list", &bytes);
  }
  for (PetscInt64 k = 0; k < count; ++k) {
    PetscReal unused;

    if (property->role == EQM_PLY_ROLE_CORNERS) {
      EqmTry(GrowList(sizeof(PetscInt64), lists->num_corners, &lists->corner_capacity, &lists->corners));
      EqmTry(ReadWhole(in, header, property->type, &lists->corners[lists->num_corners++]));
    } else if (property->role == EQM_PLY_ROLE_TEXTURE) {
      EqmTry(GrowList(sizeof(PetscReal), lists->num_reals, &lists->real_capacity, &lists->reals));
      EqmTry(ReadNumber(in, header, property->type, &lists->reals[lists->num_reals++]));
    } else {
      EqmTry(ReadNumber(in, header, property->type, &unused));
    }
  }
  return 0;
}

/* The texture point of a corner: its own, or that of its vertex, or none. */
static PetscErrorCode AddFace(const EqmPlyHeader *header, const EqmPlyElement *element, const char *position,
                              const Lists *lists, EqmBuilder *builder)
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

/* Where the numbers of a vertex or face go that have no role. */
static PetscErrorCode KeepProperties(const EqmPlyHeader *header, EqmPlyElement *element, EqmBuilder *builder)
{
  if (!element->is_vertex && !element->is_face) return 0;
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    EqmPlyProperty *const property = &element->property[p];
    const PetscBool lone =
        property->role == EQM_PLY_ROLE_S || property->role == EQM_PLY_ROLE_T ? PETSC_TRUE : PETSC_FALSE;

    if (property->count_type || (property->role != EQM_PLY_ROLE_NONE && !(lone && !header->textured))) continue;
    EqmTry(EqmBuilderAddField(builder, property->name, property->name_length, element->is_face, 1,
                              (size_t)element->count, &property->values));
  }
  return 0;
}

/* Row i: one vertex, whose coordinates go to x and (where there are some) uv, or one face, or a row to be skipped. */
static PetscErrorCode ReadRow(EqmInput *in, const EqmPlyHeader *header, const EqmPlyElement *element, PetscInt64 i,
                              EqmBuilder *builder, PetscReal *x, PetscReal *uv, Lists *lists)
{
  const char *position = in->cursor;

  if (header->ascii) EqmSkipSpace(in, 0);
  lists->num_corners = lists->num_reals = 0;
  for (PetscInt p = 0; p < element->num_properties; ++p) {
    const EqmPlyProperty *property = &element->property[p];
    PetscReal value;

    if (property->count_type) {
      EqmTry(ReadList(in, header, property, lists));
      continue;
    }
    EqmTry(ReadNumber(in, header, property->type, &value));
    if (property->values) property->values[i] = value;
    if (property->role >= EQM_PLY_ROLE_X && property->role <= EQM_PLY_ROLE_Z)
      x[property->role - EQM_PLY_ROLE_X] = value;
    if (property->role >= EQM_PLY_ROLE_S && property->role <= EQM_PLY_ROLE_T && uv)
      uv[property->role - EQM_PLY_ROLE_S] = value;
  }
  return element->is_face || element->is_strips ? AddFace(header, element, position, lists, builder) : 0;
}

/* EqmPlyParseRows - the rows of an element. Not collective. Errors: EQM_ERR_IO, EQM_ERR_MESH (quiet). */
PetscErrorCode EqmPlyParseRows(EqmInput *in, const EqmPlyHeader *header, EqmPlyElement *element, EqmBuilder *builder)
{
  const size_t smallest = EqmPlySmallestRow(header, element);
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
  EqmTry(KeepProperties(header, element, builder));
  for (PetscInt64 i = 0; i < element->count && !code; ++i) {
    EqmBuilderSetRow(builder, element->is_face ? i : -1); /* what is in strips has no row */
    code = ReadRow(in, header, element, i, builder, vertices ? vertices + 3 * i : NULL, uv ? uv + 2 * i : NULL, &lists);
  }
  EqmTry(PetscFree(lists.corners));
  EqmTry(PetscFree(lists.reals));
  return code;
}
