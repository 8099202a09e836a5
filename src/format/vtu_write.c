/* VTU with appended base64 data: well-formed XML that every VTK program reads, all doubles as they are. */
#include "encoding.h"
#include "writers.h"
#include "input.h"
#include "scalar.h"
#include "stream.h"

/* The arrays of the file in the order of their data, to say where each begins before it is written. */
typedef struct {
  EqmAtomicFile *file;
  size_t offset; /* characters of base64 text so far */
} Layout;

static void PrintName(EqmAtomicFile *file, const char *name)
{
  for (const char *c = name; *c; ++c) {
    if (*c == '&') {
      EqmAtomicPrint(file, "&amp;");
    } else if (*c == '<') {
      EqmAtomicPrint(file, "&lt;");
    } else if (*c == '"') {
      EqmAtomicPrint(file, "&quot;");
    } else {
      EqmAtomicWrite(file, c, 1);
    }
  }
}

static void DeclareArray(Layout *layout, const char *type, const char *name, PetscInt width, size_t num_bytes)
{
  EqmAtomicPrint(layout->file, "        <DataArray type=\"%s\" Name=\"", type);
  PrintName(layout->file, name);
  EqmAtomicPrint(layout->file, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%zu\"/>\n", (int)width,
                 layout->offset);
  layout->offset += EqmBase64Length(sizeof(uint64_t) + num_bytes);
}

static void DeclareFields(Layout *layout, const char *element, const EqmField *fields, PetscInt num_fields,
                          PetscBool on_cells, size_t count)
{
  EqmAtomicPrint(layout->file, "      <%s>\n", element);
  for (PetscInt f = 0; f < num_fields; ++f) {
    if (fields[f].on_cells != on_cells) continue;
    DeclareArray(layout, "Float64", fields[f].name, fields[f].width, count * (size_t)fields[f].width * sizeof(double));
  }
  EqmAtomicPrint(layout->file, "      </%s>\n", element);
}

static void PrintDocument(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields, PetscInt num_fields)
{
  const size_t num_vertices = (size_t)mesh->num_vertices, num_cells = (size_t)mesh->num_cells;
  Layout layout = {file, 0};

  EqmAtomicPrint(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                       "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n");
  EqmAtomicPrint(file, "    <Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n", num_vertices, num_cells);
  DeclareFields(&layout, "PointData", fields, num_fields, PETSC_FALSE, num_vertices);
  DeclareFields(&layout, "CellData", fields, num_fields, PETSC_TRUE, num_cells);
  EqmAtomicPrint(file, "      <Points>\n");
  DeclareArray(&layout, "Float64", "Points", 3, 3 * num_vertices * sizeof(double));
  EqmAtomicPrint(file, "      </Points>\n      <Cells>\n");
  DeclareArray(&layout, "Int64", "connectivity", 1, (size_t)mesh->cell_size * num_cells * sizeof(int64_t));
  DeclareArray(&layout, "Int64", "offsets", 1, num_cells * sizeof(int64_t));
  DeclareArray(&layout, "UInt8", "types", 1, num_cells);
  EqmAtomicPrint(file, "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"base64\">\n_");
}

/* All rows of a column of reals. */
static void WriteReals(EqmAtomicFile *file, EqmColumn *column)
{
  const uint64_t num_bytes = (uint64_t)column->total * column->row_bytes;
  EqmBase64Writer writer;

  EqmBase64Open(&writer, file);
  EqmBase64Write(&writer, &num_bytes, sizeof(num_bytes));
  for (PetscInt row = 0; row < column->total; row = column->first + column->count) {
    const void *const rows = EqmColumnRow(column, row);

    EqmBase64Write(&writer, rows, (size_t)(column->first + column->count - row) * column->row_bytes);
  }
  EqmBase64Close(&writer);
}

static void WriteFields(EqmAtomicFile *file, EqmMeshStream *stream, PetscBool on_cells)
{
  for (PetscInt f = 0; f < stream->num_fields; ++f) {
    if (stream->fields[f].on_cells == on_cells) WriteReals(file, &stream->columns[EQM_COLUMN_FIELDS + f]);
  }
}

static void WriteConnectivity(EqmAtomicFile *file, EqmMeshStream *stream)
{
  const PetscInt size = stream->mesh.cell_size;
  const uint64_t num_bytes = (uint64_t)size * (uint64_t)stream->mesh.num_cells * sizeof(int64_t);
  EqmBase64Writer writer;

  EqmBase64Open(&writer, file);
  EqmBase64Write(&writer, &num_bytes, sizeof(num_bytes));
  for (PetscInt i = 0; i < stream->mesh.num_cells; ++i) {
    const PetscInt *const cell = EqmStreamCell(stream, i);

    for (PetscInt k = 0; k < size; ++k) {
      const int64_t corner = cell[k];

      EqmBase64Write(&writer, &corner, sizeof(corner));
    }
  }
  EqmBase64Close(&writer);
}

static void WriteOffsets(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  const uint64_t num_bytes = (size_t)mesh->num_cells * sizeof(int64_t);
  EqmBase64Writer writer;

  EqmBase64Open(&writer, file);
  EqmBase64Write(&writer, &num_bytes, sizeof(num_bytes));
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    const int64_t end = (int64_t)mesh->cell_size * ((int64_t)i + 1);

    EqmBase64Write(&writer, &end, sizeof(end));
  }
  EqmBase64Close(&writer);
}

static void WriteTypes(EqmAtomicFile *file, const EqmSerialMesh *mesh)
{
  const uint64_t num_bytes = (size_t)mesh->num_cells;
  const uint8_t type = mesh->cell_size == 3 ? 5 : 10; /* VTK's triangle and tetrahedron */
  EqmBase64Writer writer;

  EqmBase64Open(&writer, file);
  EqmBase64Write(&writer, &num_bytes, sizeof(num_bytes));
  for (PetscInt i = 0; i < mesh->num_cells; ++i) EqmBase64Write(&writer, &type, 1);
  EqmBase64Close(&writer);
}

/* EqmWriteVtu - write a VTU file, fields as point and cell data. See EqmStreamWriter. */
PetscErrorCode EqmWriteVtu(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  PrintDocument(file, &stream->mesh, stream->fields, stream->num_fields);
  WriteFields(file, stream, PETSC_FALSE);
  WriteFields(file, stream, PETSC_TRUE);
  WriteReals(file, &stream->columns[EQM_COLUMN_VERTICES]);
  WriteConnectivity(file, stream);
  WriteOffsets(file, &stream->mesh);
  WriteTypes(file, &stream->mesh);
  EqmAtomicPrint(file, "\n  </AppendedData>\n</VTKFile>\n");
  return 0;
}
