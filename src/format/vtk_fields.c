/* Numbers of a legacy VTK file, and the fields that follow its mesh. */
#include "vtk.h"

#include <string.h>

/* EqmVtkReadType - the name of a type of numbers. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmVtkReadType(EqmInput *in, EqmScalarType *type)
{
  static const struct {
    const char *name;
    EqmScalarType type;
  } known[] = {{"float", EQM_SCALAR_FLOAT32},
               {"double", EQM_SCALAR_FLOAT64},
               {"int", EQM_SCALAR_INT32},
               {"unsigned_int", EQM_SCALAR_UINT32},
               {"long", EQM_SCALAR_INT64},
               {"unsigned_long", EQM_SCALAR_UINT64},
               {"vtktypeint64", EQM_SCALAR_INT64},
               {"vtktypeuint64", EQM_SCALAR_UINT64},
               {"vtktypeint32", EQM_SCALAR_INT32},
               {"vtktypeuint32", EQM_SCALAR_UINT32},
               {"vtkIdType", EQM_SCALAR_INT32},
               {"short", EQM_SCALAR_INT16},
               {"unsigned_short", EQM_SCALAR_UINT16},
               {"char", EQM_SCALAR_INT8},
               {"unsigned_char", EQM_SCALAR_UINT8}};

  for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); ++i) {
    if (EqmReadKeyword(in, known[i].name)) {
      *type = known[i].type;
      return 0;
    }
  }
  return EqmReject(in, EQM_ERR_IO,
                   "unknown data type; known are float, double, int, long, short, char and unsigned ones");
}

/* Can the rest of the file hold so many numbers? To be checked before memory is allocated for them. */
PetscErrorCode EqmVtkCheckRoom(EqmVtk *vtk, EqmScalarType type, PetscInt64 count)
{
  const size_t bytes_each = vtk->ascii ? 2 : EqmScalarSize(type);

  if (count >= 0 && (size_t)count <= (EqmRemaining(vtk->in) + 1) / bytes_each) return 0;
  return EqmReject(vtk->in, EQM_ERR_IO,
                   "%lld numbers are announced, but the file is too short for them: it is truncated", (long long)count);
}

PetscErrorCode EqmVtkReadReals(EqmVtk *vtk, EqmScalarType type, PetscInt64 count, PetscReal *values)
{
  const char *bytes;

  if (vtk->ascii) {
    for (PetscInt64 i = 0; i < count; ++i) {
      EqmSkipSpace(vtk->in, 0);
      if (!EqmReadReal(vtk->in, &values[i])) return EqmReject(vtk->in, EQM_ERR_IO, "a number is missing");
    }
    return 0;
  }
  EqmTry(EqmTakeBytes(vtk->in, (size_t)count * EqmScalarSize(type), "data", &bytes));
  for (PetscInt64 i = 0; i < count; ++i) {
    values[i] = EqmLoadReal(bytes + (size_t)i * EqmScalarSize(type), type, PETSC_TRUE);
  }
  return 0;
}

PetscErrorCode EqmVtkReadTwoCounts(EqmVtk *vtk, PetscInt64 *first, PetscInt64 *second)
{
  if (EqmReadInteger(vtk->in, first) && EqmReadInteger(vtk->in, second) && *first >= 0 && *second >= 0) return 0;
  return EqmReject(vtk->in, EQM_ERR_IO, "two numbers must follow the name of a section");
}

/* Arrays that belong to the file, not to its points or cells. */
PetscErrorCode EqmVtkSkipField(EqmVtk *vtk)
{
  const char *word, *bytes;
  PetscInt64 num_arrays, width, length;
  EqmScalarType type;

  EqmReadWord(vtk->in, &word);
  EqmTry(EqmReadCount(vtk->in, "arrays", 8, &num_arrays));
  for (PetscInt64 a = 0; a < num_arrays; ++a) {
    EqmSkipSpace(vtk->in, 0);
    EqmReadWord(vtk->in, &word);
    EqmTry(EqmVtkReadTwoCounts(vtk, &width, &length));
    EqmTry(EqmVtkReadType(vtk->in, &type));
    EqmSkipLine(vtk->in);
    if (width && length > (PetscInt64)EqmRemaining(vtk->in) / width) {
      return EqmReject(vtk->in, EQM_ERR_IO, "the file ends inside an array: it is truncated");
    }
    if (!vtk->ascii) EqmTry(EqmTakeBytes(vtk->in, (size_t)(width * length) * EqmScalarSize(type), "array", &bytes));
    for (PetscInt64 i = 0; vtk->ascii && i < width * length; ++i) {
      EqmSkipSpace(vtk->in, 0);
      if (!EqmReadWord(vtk->in, &word)) return EqmReject(vtk->in, EQM_ERR_IO, "the file ends inside an array");
    }
  }
  return 0;
}

/* EqmVtkSkipMetadata - move over a section METADATA, which ends with an empty line. Not collective. */
void EqmVtkSkipMetadata(EqmInput *in)
{
  EqmSkipLine(in);
  while (in->cursor < in->end && !EqmAtLineEnd(in)) EqmSkipLine(in);
}

/* A kind of attribute: its keyword, and how many numbers a row of it has. */
typedef struct {
  const char *keyword;
  PetscInt64 width; /* 0: stands in the file */
} Attribute;

static const Attribute attributes[] = {
    {"SCALARS", 0}, {"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TEXTURE_COORDINATES", 0}, {"COLOR_SCALARS", -1}};

/* One array of `rows` rows under a name; what does not fit the mesh is dropped at the end. */
static PetscErrorCode TakeArray(EqmVtk *vtk, const char *name, size_t length, PetscBool on_cells, EqmScalarType type,
                                PetscInt64 width, PetscInt64 rows)
{
  PetscReal *values, *unused = NULL;
  PetscErrorCode code;

  if (width < 0 || width > 1000 || rows > PETSC_MAX_INT) return EqmReject(vtk->in, EQM_ERR_IO, "an array is too large");
  EqmTry(EqmVtkCheckRoom(vtk, type, width * rows));
  EqmTry(EqmBuilderAddField(&vtk->builder, name, length, on_cells, width, (size_t)rows, &values));
  if (!values) EqmTry(PetscMalloc1(width * rows + 1, &unused));
  code = EqmVtkReadReals(vtk, type, width * rows, values ? values : unused);
  if (code && values) EqmTry(EqmBuilderDropField(&vtk->builder));
  EqmTry(PetscFree(unused));
  return code;
}

/* FIELD name number, and the arrays. */
static PetscErrorCode ParseFieldData(EqmVtk *vtk, PetscBool on_cells)
{
  const char *word;
  PetscInt64 num_arrays;

  EqmReadWord(vtk->in, &word);
  EqmTry(EqmReadCount(vtk->in, "arrays", 8, &num_arrays));
  for (PetscInt64 a = 0; a < num_arrays; ++a) {
    PetscInt64 width, rows;
    EqmScalarType type;
    size_t length;

    EqmSkipSpace(vtk->in, 0);
    if (EqmReadKeyword(vtk->in, "METADATA")) { /* of the array before */
      EqmVtkSkipMetadata(vtk->in);
      EqmSkipSpace(vtk->in, 0);
    }
    length = EqmReadWord(vtk->in, &word);
    EqmTry(EqmVtkReadTwoCounts(vtk, &width, &rows));
    EqmTry(EqmVtkReadType(vtk->in, &type));
    EqmSkipLine(vtk->in);
    EqmTry(TakeArray(vtk, word, length, on_cells, type, width, rows));
  }
  return 0;
}

/* SCALARS name type [width] and perhaps a line LOOKUP_TABLE; the others alike. */
static PetscErrorCode ParseAttribute(EqmVtk *vtk, const Attribute *attribute, PetscBool on_cells, PetscInt64 rows)
{
  const PetscBool is_scalars = attribute == attributes ? PETSC_TRUE : PETSC_FALSE;
  PetscInt64 width = attribute->width ? attribute->width : 1;
  EqmScalarType type;
  EqmInput after;
  const char *name;
  const size_t length = EqmReadWord(vtk->in, &name);

  if (attribute->width < 0) return EqmReject(vtk->in, EQM_ERR_IO, "colours are not read");
  if (!is_scalars && !attribute->width && !EqmReadInteger(vtk->in, &width))
    return EqmReject(vtk->in, EQM_ERR_IO, "a dimension is missing");
  EqmTry(EqmVtkReadType(vtk->in, &type));
  if (is_scalars && !EqmAtLineEnd(vtk->in) && !EqmReadInteger(vtk->in, &width))
    return EqmReject(vtk->in, EQM_ERR_IO, "a number of components is missing");
  EqmSkipLine(vtk->in);
  after = *vtk->in;
  if (is_scalars && EqmReadKeyword(&after, "LOOKUP_TABLE")) {
    EqmSkipLine(&after);
    vtk->in->cursor = after.cursor;
  }
  return TakeArray(vtk, name, length, on_cells, type, width, rows);
}

/* One part of POINT_DATA or CELL_DATA; `on_cells` and `rows` change with the section. */
static PetscErrorCode ParsePart(EqmVtk *vtk, PetscBool *on_cells, PetscInt64 *rows)
{
  EqmInput *const in = vtk->in;
  const PetscBool points = EqmReadKeyword(in, "POINT_DATA");

  if (points || EqmReadKeyword(in, "CELL_DATA")) {
    *on_cells = points ? PETSC_FALSE : PETSC_TRUE;
    return EqmReadCount(in, "rows", 1, rows);
  }
  if (EqmReadKeyword(in, "FIELD")) return ParseFieldData(vtk, *on_cells);
  if (EqmReadKeyword(in, "METADATA")) {
    EqmVtkSkipMetadata(in);
    return 0;
  }
  for (size_t k = 0; k < sizeof(attributes) / sizeof(attributes[0]); ++k) {
    if (EqmReadKeyword(in, attributes[k].keyword)) return ParseAttribute(vtk, &attributes[k], *on_cells, *rows);
  }
  return EqmReject(in, EQM_ERR_IO, "an array was expected");
}

/* EqmVtkParseFields - the arrays behind POINT_DATA (or CELL_DATA, with `on_cells`), to the end of the file. Not
   collective. The mesh is complete without them: at the first array that is not understood the rest is left. */
PetscErrorCode EqmVtkParseFields(EqmVtk *vtk, PetscBool on_cells)
{
  PetscInt64 rows;
  PetscErrorCode code = EqmReadCount(vtk->in, "rows", 1, &rows);

  for (EqmSkipSpace(vtk->in, 0); !code && vtk->in->cursor < vtk->in->end; EqmSkipSpace(vtk->in, 0))
    code = ParsePart(vtk, &on_cells, &rows);
  vtk->in->cursor = vtk->in->end;
  if (code == EQM_ERR_IO) EqmBuilderNoteLeft(&vtk->builder, "arrays that are not understood");
  return code == EQM_ERR_IO ? 0 : code;
}
