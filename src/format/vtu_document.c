/* The XML document of a VTU or VTP file, and through it the arrays. */
#include "vtkcells.h"
#include "vtu.h"

#include <string.h>

/* What the root element says about the arrays. */
static PetscErrorCode ParseEncoding(EqmVtuEncoding *encoding, xmlNodePtr root)
{
  char text[64];

  EqmXmlAttribute(root, "byte_order", text, sizeof(text));
  encoding->big_endian = strcmp(text, "BigEndian") ? PETSC_FALSE : PETSC_TRUE;
  EqmXmlAttribute(root, "header_type", text, sizeof(text));
  encoding->header = strcmp(text, "UInt64") ? EQM_SCALAR_UINT32 : EQM_SCALAR_UINT64;
  if (text[0] && strcmp(text, "UInt64") && strcmp(text, "UInt32")) {
    return EqmXmlReject(encoding->in, root, "unknown header_type \"%s\"; known are UInt32 and UInt64", text);
  }
  EqmXmlAttribute(root, "compressor", text, sizeof(text));
  encoding->compressed = text[0] ? PETSC_TRUE : PETSC_FALSE;
  if (encoding->compressed && strcmp(text, "vtkZLibDataCompressor")) {
    return EqmXmlReject(encoding->in, root,
                        "the compressor %s is not supported; save with vtkZLibDataCompressor or without", text);
  }
  EqmXmlAttribute(EqmXmlChild(root, "AppendedData"), "encoding", text, sizeof(text));
  encoding->appended_base64 = strcmp(text, "base64") ? PETSC_FALSE : PETSC_TRUE;
  return 0;
}

/* The DataArray of this name, or (NULL) the first one. */
static PetscErrorCode FindArray(EqmInput *in, xmlNodePtr parent, const char *name, xmlNodePtr *array)
{
  char found[64];

  for (*array = EqmXmlChild(parent, "DataArray"); *array; *array = EqmXmlNext(*array, "DataArray")) {
    EqmXmlAttribute(*array, "Name", found, sizeof(found));
    if (!name || !strcmp(found, name)) return 0;
  }
  return EqmXmlReject(in, parent, "it has no DataArray %s", name ? name : "of coordinates");
}

static PetscErrorCode ParsePoints(const EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr piece,
                                  PetscInt64 *num_points)
{
  xmlNodePtr points = EqmXmlChild(piece, "Points"), array;
  PetscInt64 width = 3;
  EqmVtuRange range;
  PetscReal *x;

  if (!EqmXmlInteger(piece, "NumberOfPoints", num_points) || *num_points < 0) {
    return EqmXmlReject(encoding->in, piece, "NumberOfPoints is missing or not a whole number");
  }
  if (!*num_points) return 0;
  if (!points) return EqmXmlReject(encoding->in, piece, "it has no Points");
  EqmTry(FindArray(encoding->in, points, NULL, &array));
  if (!EqmXmlInteger(array, "NumberOfComponents", &width) || width != 3) {
    return EqmXmlReject(encoding->in, array, "points need NumberOfComponents=\"3\"");
  }
  if (*num_points > PETSC_MAX_INT) return EqmXmlReject(encoding->in, piece, "more points than indices can count");
  EqmTry(EqmVtuCheckRoom(encoding, array, 3 * *num_points));
  range = EqmVtuShare(encoding, *num_points, 3);
  EqmTry(EqmBuilderAddVertices(builder, (size_t)range.count / 3, &x));
  return EqmVtuReadReals(encoding, array, range, x);
}

/* Count the corners of this rank's cells from the first of them on. */
static PetscErrorCode ShiftOffsets(EqmVtkCells *cells, PetscInt64 base, PetscInt64 num_corners)
{
  cells->num_corners = cells->num_cells ? cells->end[cells->num_cells - 1] : base;
  for (PetscInt64 i = 0; i < cells->num_cells; ++i) {
    if (cells->end[i] < base || cells->end[i] > num_corners) return EQM_ERR_IO;
    cells->end[i] -= base;
  }
  cells->num_corners -= base;
  return 0;
}

/* The number at `index` of an array. */
static PetscErrorCode ReadInteger(const EqmVtuEncoding *encoding, xmlNodePtr array, PetscInt64 total, PetscInt64 index,
                                  PetscInt64 *value)
{
  PetscInt64 *values = NULL;
  const PetscErrorCode code = EqmVtuReadIntegers(encoding, array, (EqmVtuRange){total, index, 1}, &values);

  if (!code) *value = values[0];
  EqmTry(PetscFree(values));
  return code;
}

/* Types (of grids, not of surfaces), offsets and connectivity, whose length is the last offset. */
static PetscErrorCode ReadCells(const EqmVtuEncoding *encoding, xmlNodePtr parent, PetscBool has_types,
                                EqmVtkCells *cells)
{
  const PetscInt64 total = cells->num_cells;
  const EqmVtuRange own = EqmVtuShare(encoding, total, 1);
  PetscInt64 base = 0, num_corners;
  xmlNodePtr array;

  cells->num_cells = own.count;
  if (has_types) {
    EqmTry(FindArray(encoding->in, parent, "types", &array));
    EqmTry(EqmVtuReadIntegers(encoding, array, own, &cells->type));
  }
  EqmTry(FindArray(encoding->in, parent, "offsets", &array));
  EqmTry(EqmVtuReadIntegers(encoding, array, own, &cells->end));
  if (own.first > 0) EqmTry(ReadInteger(encoding, array, total, own.first - 1, &base));
  if (own.first + own.count < total) {
    EqmTry(ReadInteger(encoding, array, total, total - 1, &num_corners));
  } else {
    num_corners = own.count ? cells->end[own.count - 1] : base;
  }
  if (own.count < total) {
    if (base < 0 || base > num_corners) return EQM_ERR_IO;
    EqmTry(ShiftOffsets(cells, base, num_corners));
  } else {
    cells->num_corners = num_corners;
  }
  EqmTry(FindArray(encoding->in, parent, "connectivity", &array));
  return EqmVtuReadIntegers(encoding, array, (EqmVtuRange){num_corners, base, cells->num_corners}, &cells->corners);
}

/* A kind of cells in a piece: the attribute with their number and the element with their arrays. */
typedef struct {
  const char *count, *element;
  PetscBool has_types, strips;
} CellKind;

static PetscErrorCode ParseCells(const EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr piece,
                                 const CellKind *kind, PetscInt64 first_vertex, PetscInt64 num_points, PetscInt64 *row)
{
  EqmVtkCells cells = {.strips = kind->strips, .first_row = *row};
  PetscErrorCode code;

  if (!EqmXmlInteger(piece, kind->count, &cells.num_cells) || cells.num_cells < 0) {
    if (kind->strips) return 0;
    return EqmXmlReject(encoding->in, piece, "%s is missing or not a whole number", kind->count);
  }
  *row += cells.num_cells;
  if (!cells.num_cells) return 0;
  if (!EqmXmlChild(piece, kind->element)) return EqmXmlReject(encoding->in, piece, "it has no %s", kind->element);
  code = ReadCells(encoding, EqmXmlChild(piece, kind->element), kind->has_types, &cells);
  if (!code) code = EqmBuilderAddVtkCells(builder, &cells, first_vertex, num_points);
  EqmTry(EqmVtkCellsReset(&cells));
  return code;
}

/* The arrays of PointData or CellData; one that cannot be read, of texts say, is left out. */
static PetscErrorCode ParseFields(const EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr parent,
                                  PetscBool on_cells, PetscInt64 num_rows)
{
  for (xmlNodePtr array = EqmXmlChild(parent, "DataArray"); array; array = EqmXmlNext(array, "DataArray")) {
    char name[EQM_FIELD_NAME], type[32];
    PetscInt64 width = 1;
    EqmVtuRange range;
    PetscReal *values;
    PetscErrorCode code;

    EqmXmlAttribute(array, "Name", name, sizeof(name));
    EqmXmlAttribute(array, "type", type, sizeof(type));
    if (!strcmp(type, "String")) {
      EqmBuilderNoteLeft(builder, name);
      continue;
    }
    if (EqmXmlInteger(array, "NumberOfComponents", &width) && (width < 1 || width > PETSC_MAX_INT / 4)) continue;
    if (EqmVtuCheckRoom(encoding, array, width * num_rows)) continue;
    range = EqmVtuShare(encoding, num_rows, width);
    EqmTry(EqmBuilderAddField(builder, name, strlen(name), on_cells, width, (size_t)(range.count / width), &values));
    code = values ? EqmVtuReadReals(encoding, array, range, values) : 0;
    if (code && encoding->file) return code; /* other ranks may have been able to read theirs */
    if (code) {
      EqmBuilderNoteLeft(builder, name);
      EqmTry(EqmBuilderDropField(builder));
    }
  }
  return 0;
}

/* Fields of a file of one piece; of several no more than the first has them. */
static PetscErrorCode ParsePieceFields(const EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr piece,
                                       PetscInt64 num_points, PetscInt64 num_rows)
{
  const xmlNodePtr points = EqmXmlChild(piece, "PointData"), cells = EqmXmlChild(piece, "CellData");

  if (points) EqmTry(ParseFields(encoding, builder, points, PETSC_FALSE, num_points));
  return cells ? ParseFields(encoding, builder, cells, PETSC_TRUE, num_rows) : 0;
}

/* How many cells of a surface stand before its polygons among the rows of the cell fields. */
static PetscInt64 RowsBefore(xmlNodePtr piece)
{
  PetscInt64 vertices = 0, lines = 0;

  if (!EqmXmlInteger(piece, "NumberOfVerts", &vertices) || vertices < 0) vertices = 0;
  if (!EqmXmlInteger(piece, "NumberOfLines", &lines) || lines < 0) lines = 0;
  return PetscMin(vertices, PETSC_MAX_INT) + PetscMin(lines, PETSC_MAX_INT);
}

static PetscErrorCode ParsePiece(const EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr piece,
                                 PetscBool surface)
{
  static const CellKind grid = {"NumberOfCells", "Cells", PETSC_TRUE, PETSC_FALSE},
                        polygons = {"NumberOfPolys", "Polys", PETSC_FALSE, PETSC_FALSE},
                        strips = {"NumberOfStrips", "Strips", PETSC_FALSE, PETSC_TRUE};
  const PetscInt64 first_vertex = (PetscInt64)builder->num_vertices;
  PetscInt64 num_points, row = surface ? RowsBefore(piece) : 0;

  EqmTry(ParsePoints(encoding, builder, piece, &num_points));
  EqmTry(ParseCells(encoding, builder, piece, surface ? &polygons : &grid, first_vertex, num_points, &row));
  if (surface) EqmTry(ParseCells(encoding, builder, piece, &strips, first_vertex, num_points, &row));
  return first_vertex ? 0 : ParsePieceFields(encoding, builder, piece, num_points, row);
}

PetscErrorCode EqmVtuParseDocument(EqmVtuEncoding *encoding, EqmBuilder *builder, xmlNodePtr root)
{
  xmlNodePtr grid, surface;
  char type[32];

  EqmXmlAttribute(root, "type", type, sizeof(type));
  if (!EqmXmlIs(root, "VTKFile")) return EqmXmlReject(encoding->in, root, "a VTU file has the root element VTKFile");
  grid = EqmXmlChild(root, "UnstructuredGrid");
  surface = EqmXmlChild(root, "PolyData");
  if (!grid && !surface) {
    return EqmXmlReject(encoding->in, root,
                        "type \"%s\" is no mesh of triangles or tetrahedra; UnstructuredGrid and PolyData "
                        "are",
                        type);
  }
  EqmTry(ParseEncoding(encoding, root));
  for (xmlNodePtr piece = EqmXmlChild(grid ? grid : surface, "Piece"); piece; piece = EqmXmlNext(piece, "Piece")) {
    const size_t before = builder->num_vertices;

    EqmTry(ParsePiece(encoding, builder, piece, grid ? PETSC_FALSE : PETSC_TRUE));
    if (before && builder->num_vertices > before) {
      if (builder->num_fields) EqmBuilderNoteLeft(builder, "fields of several pieces");
      while (builder->num_fields) EqmTry(EqmBuilderDropField(builder));
    }
  }
  return 0;
}
