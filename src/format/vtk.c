/* Legacy VTK: POLYDATA and UNSTRUCTURED_GRID, ASCII and binary, versions 1 to 5.1. */
#include "writers.h"
#include "vtk.h"

#include <string.h>

/* The first line. Not collective. */
static PetscBool RecogniseVtk(const char *bytes, size_t length)
{
  static const char magic[] = "# vtk DataFile Version";

  return length >= sizeof(magic) - 1 && !memcmp(bytes, magic, sizeof(magic) - 1) ? PETSC_TRUE : PETSC_FALSE;
}

/* Whole numbers into an array that is allocated here. */
static PetscErrorCode ReadIntegers(EqmVtk *vtk, EqmScalarType type, PetscInt64 count, PetscInt64 **values)
{
  const char *bytes;

  EqmTry(EqmVtkCheckRoom(vtk, type, count));
  EqmTry(PetscMalloc1(count + 1, values));
  if (vtk->ascii) {
    for (PetscInt64 i = 0; i < count; ++i) {
      EqmSkipSpace(vtk->in, 0);
      if (!EqmReadInteger(vtk->in, &(*values)[i])) return EqmReject(vtk->in, EQM_ERR_IO, "a whole number is missing");
    }
    return 0;
  }
  EqmTry(EqmTakeBytes(vtk->in, (size_t)count * EqmScalarSize(type), "data", &bytes));
  for (PetscInt64 i = 0; i < count; ++i) {
    (*values)[i] = EqmLoadInteger(bytes + (size_t)i * EqmScalarSize(type), type, PETSC_TRUE);
  }
  return 0;
}

static PetscErrorCode ParsePoints(EqmVtk *vtk)
{
  PetscInt64 count;
  EqmScalarType type;
  PetscReal *x;

  EqmTry(EqmReadCount(vtk->in, "points", 3, &count));
  EqmTry(EqmVtkReadType(vtk->in, &type));
  EqmSkipLine(vtk->in);
  if (vtk->builder.num_vertices) return EqmReject(vtk->in, EQM_ERR_IO, "a second section POINTS");
  EqmTry(EqmVtkCheckRoom(vtk, type, 3 * count));
  EqmTry(EqmBuilderAddVertices(&vtk->builder, (size_t)count, &x));
  return EqmVtkReadReals(vtk, type, 3 * count, x);
}

/* Before version 5: each cell is its number of corners and the corners, in one array. */
static PetscErrorCode SplitCells(EqmVtk *vtk, PetscInt64 num_cells, PetscInt64 size, EqmVtkCells *cells)
{
  PetscInt64 from = 0, to = 0;

  if (num_cells > size) return EqmReject(vtk->in, EQM_ERR_IO, "more cells are announced than numbers for them");
  EqmTry(ReadIntegers(vtk, EQM_SCALAR_INT32, size, &cells->corners));
  EqmTry(PetscMalloc1(num_cells + 1, &cells->end));
  for (PetscInt64 i = 0; i < num_cells; ++i) {
    const PetscInt64 num_corners = from < size ? cells->corners[from++] : -1;

    if (num_corners < 0 || num_corners > size - from) {
      return EqmReject(vtk->in, EQM_ERR_IO, "cell %lld does not fit into the numbers of its section", (long long)i);
    }
    for (PetscInt64 k = 0; k < num_corners; ++k) cells->corners[to++] = cells->corners[from++];
    cells->end[i] = to;
  }
  cells->num_cells = num_cells;
  cells->num_corners = to;
  return 0;
}

/* From version 5 on: one offset more than there are cells, and the corners. */
static PetscErrorCode ReadOffsets(EqmVtk *vtk, PetscInt64 num_offsets, PetscInt64 num_corners, EqmVtkCells *cells)
{
  EqmScalarType type;

  EqmTry(EqmVtkReadType(vtk->in, &type));
  EqmSkipLine(vtk->in);
  EqmTry(ReadIntegers(vtk, type, num_offsets, &cells->end));
  EqmSkipSpace(vtk->in, 0);
  if (!EqmReadKeyword(vtk->in, "CONNECTIVITY"))
    return EqmReject(vtk->in, EQM_ERR_IO, "CONNECTIVITY must follow OFFSETS");
  EqmTry(EqmVtkReadType(vtk->in, &type));
  EqmSkipLine(vtk->in);
  EqmTry(ReadIntegers(vtk, type, num_corners, &cells->corners));
  cells->num_cells = PetscMax(num_offsets - 1, 0);
  cells->num_corners = num_corners;
  for (PetscInt64 i = 0; i < cells->num_cells; ++i) cells->end[i] = cells->end[i + 1]; /* the first offset is 0 */
  return 0;
}

static PetscErrorCode ReadCells(EqmVtk *vtk, EqmVtkCells *cells)
{
  PetscInt64 first, second;
  EqmInput after;

  EqmTry(EqmVtkReadTwoCounts(vtk, &first, &second));
  EqmSkipLine(vtk->in);
  after = *vtk->in;
  EqmSkipSpace(&after, 0);
  if (EqmReadKeyword(&after, "OFFSETS")) {
    vtk->in->cursor = after.cursor;
    return ReadOffsets(vtk, first, second, cells);
  }
  return SplitCells(vtk, first, second, cells);
}

/* Cells of a surface: polygons, triangle strips, or vertices and lines, which are skipped. */
typedef enum { CELLS_POLYGONS, CELLS_STRIPS, CELLS_SKIPPED } SurfaceCells;

static PetscErrorCode ParseSurfaceCells(EqmVtk *vtk, SurfaceCells kind)
{
  EqmVtkCells cells = {.strips = kind == CELLS_STRIPS ? PETSC_TRUE : PETSC_FALSE, .first_row = vtk->num_rows};
  PetscErrorCode code = ReadCells(vtk, &cells);

  vtk->num_rows += cells.num_cells;
  if (!code && kind != CELLS_SKIPPED)
    code = EqmBuilderAddVtkCells(&vtk->builder, &cells, 0, (PetscInt64)vtk->builder.num_vertices);
  EqmTry(EqmVtkCellsReset(&cells));
  return code;
}

static PetscErrorCode ParseGridCells(EqmVtk *vtk)
{
  if (vtk->cells.end) return EqmReject(vtk->in, EQM_ERR_IO, "a second section CELLS");
  EqmTry(ReadCells(vtk, &vtk->cells));
  vtk->num_rows = vtk->cells.num_cells;
  return 0;
}

static PetscErrorCode ParseCellTypes(EqmVtk *vtk)
{
  PetscInt64 count;

  if (vtk->cells.type) return EqmReject(vtk->in, EQM_ERR_IO, "a second section CELL_TYPES");
  if (!EqmReadInteger(vtk->in, &count) || count != vtk->cells.num_cells) {
    return EqmReject(vtk->in, EQM_ERR_IO, "CELL_TYPES needs as many types as CELLS before it has cells (%lld)",
                     (long long)vtk->cells.num_cells);
  }
  EqmSkipLine(vtk->in);
  return ReadIntegers(vtk, EQM_SCALAR_INT32, count, &vtk->cells.type);
}

static PetscErrorCode ParseSection(EqmVtk *vtk, PetscBool *last)
{
  EqmInput *in = vtk->in;

  if (EqmReadKeyword(in, "POINTS")) return ParsePoints(vtk);
  if (vtk->polydata && EqmReadKeyword(in, "POLYGONS")) return ParseSurfaceCells(vtk, CELLS_POLYGONS);
  if (vtk->polydata && EqmReadKeyword(in, "VERTICES")) return ParseSurfaceCells(vtk, CELLS_SKIPPED);
  if (vtk->polydata && EqmReadKeyword(in, "LINES")) return ParseSurfaceCells(vtk, CELLS_SKIPPED);
  if (vtk->polydata && EqmReadKeyword(in, "TRIANGLE_STRIPS")) return ParseSurfaceCells(vtk, CELLS_STRIPS);
  if (!vtk->polydata && EqmReadKeyword(in, "CELLS")) return ParseGridCells(vtk);
  if (!vtk->polydata && EqmReadKeyword(in, "CELL_TYPES")) return ParseCellTypes(vtk);
  if (EqmReadKeyword(in, "FIELD")) return EqmVtkSkipField(vtk);
  if (EqmReadKeyword(in, "METADATA")) {
    EqmVtkSkipMetadata(in);
    return 0;
  }
  *last = PETSC_TRUE;
  if (EqmReadKeyword(in, "POINT_DATA")) return EqmVtkParseFields(vtk, PETSC_FALSE);
  if (EqmReadKeyword(in, "CELL_DATA")) return EqmVtkParseFields(vtk, PETSC_TRUE);
  return EqmReject(in, EQM_ERR_IO,
                   "a section was expected (POINTS, POLYGONS, CELLS, CELL_TYPES, ...): the file is damaged");
}

static PetscErrorCode ParseHeader(EqmVtk *vtk)
{
  EqmInput *in = vtk->in;

  EqmSkipLine(in); /* # vtk DataFile Version x.x */
  EqmSkipLine(in); /* title */
  EqmSkipSpace(in, 0);
  vtk->ascii = EqmReadKeyword(in, "ASCII");
  if (!vtk->ascii && !EqmReadKeyword(in, "BINARY")) return EqmReject(in, EQM_ERR_IO, "ASCII or BINARY must stand here");
  EqmSkipSpace(in, 0);
  if (!EqmReadKeyword(in, "DATASET")) return EqmReject(in, EQM_ERR_IO, "DATASET must stand here");
  vtk->polydata = EqmReadKeyword(in, "POLYDATA");
  if (vtk->polydata || EqmReadKeyword(in, "UNSTRUCTURED_GRID")) return 0;
  return EqmReject(in, EQM_ERR_IO,
                   "this kind of data set is not a mesh of triangles or tetrahedra; POLYDATA and "
                   "UNSTRUCTURED_GRID are");
}

static PetscErrorCode ParseMesh(EqmVtk *vtk)
{
  PetscBool last = PETSC_FALSE;

  if (!RecogniseVtk(vtk->in->start, EqmRemaining(vtk->in))) {
    return EqmReject(vtk->in, EQM_ERR_IO, "a VTK file begins with \"# vtk DataFile Version\"");
  }
  EqmTry(ParseHeader(vtk));
  vtk->in->binary = vtk->ascii ? PETSC_FALSE : PETSC_TRUE;
  for (EqmSkipSpace(vtk->in, 0); vtk->in->cursor < vtk->in->end && !last; EqmSkipSpace(vtk->in, 0)) {
    EqmTry(ParseSection(vtk, &last));
  }
  if (vtk->cells.end && !vtk->cells.type)
    return EqmReject(vtk->in, EQM_ERR_IO, "CELL_TYPES is missing: the file is truncated");
  return EqmBuilderAddVtkCells(&vtk->builder, &vtk->cells, 0, (PetscInt64)vtk->builder.num_vertices);
}

/* Read a legacy VTK file. See EqmParser. */
static PetscErrorCode ParseVtk(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmVtk vtk = {0};
  PetscErrorCode code;

  EqmInputOpen(&in, bytes, length, error, error_length);
  vtk.in = &in;
  EqmBuilderOpen(&vtk.builder, &in);
  code = ParseMesh(&vtk);
  EqmTry(EqmVtkCellsReset(&vtk.cells));
  return EqmBuilderFinish(&vtk.builder, code, mesh);
}

EQM_DEFINE_FORMAT(Vtk) = {.name = "legacy VTK",
                          .suffixes = "vtk",
                          .recognise = RecogniseVtk,
                          .parse = ParseVtk,
                          .write_stream = EqmWriteVtk,
                          .vertex_fields = PETSC_TRUE,
                          .cell_fields = PETSC_TRUE};
