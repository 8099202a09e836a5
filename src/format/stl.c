/* STL, ASCII and binary. The file repeats a vertex in every triangle; equal coordinates are taken for one vertex,
   numbered in the order of first appearance. */
#include "format.h"
#include "scalar.h"
#include "stl.h"
#include "stream.h"
#include "weld.h"

#include <string.h>

#define HEADER_BYTES EQM_STL_HEADER

/* "solid" and a facet, or a length that fits a binary header. Not collective. */
static PetscBool RecogniseStl(const char *bytes, size_t length)
{
  return EqmStlIsBinary(bytes, length) || EqmStlIsAscii(bytes, length) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ParseBinary(EqmInput *in, EqmBuilder *builder)
{
  const char *bytes;
  PetscInt64 num_triangles;

  in->binary = PETSC_TRUE;
  EqmTry(EqmTakeBytes(in, HEADER_BYTES, "header", &bytes));
  EqmTry(EqmTakeBytes(in, 4, "header", &bytes));
  num_triangles = EqmLoadInteger(bytes, EQM_SCALAR_UINT32, PETSC_FALSE);
  EqmTry(EqmTakeBytes(in, (size_t)num_triangles * EQM_STL_TRIANGLE, "triangles", &bytes));
  return EqmStlParseTriangles(bytes, (size_t)num_triangles, builder);
}

static PetscErrorCode ParseAscii(EqmInput *in, EqmBuilder *builder)
{
  PetscInt64 open_solids;

  EqmTry(EqmStlParseFacets(in, builder, &open_solids));
  if (open_solids) return EqmReject(in, EQM_ERR_IO, "the last endsolid is missing: the file is truncated");
  return 0;
}

/* Each three vertices are a triangle; vertices of equal coordinates become one. */
static PetscErrorCode WeldTriangles(EqmBuilder *builder)
{
  PetscInt *cells;

  EqmTry(EqmBuilderAddCells(builder, 3, builder->num_vertices / 3, &cells));
  return EqmWeld(builder->num_vertices, builder->vertices, &builder->num_vertices, cells);
}

static PetscErrorCode ParseMesh(EqmInput *in, EqmBuilder *builder)
{
  const size_t length = EqmRemaining(in);
  const PetscBool ascii = EqmStlIsAscii(in->start, length) && !EqmStlIsBinary(in->start, length);

  EqmTry(ascii ? ParseAscii(in, builder) : ParseBinary(in, builder));
  return WeldTriangles(builder);
}

/* Read an STL file. See EqmParser. */
static PetscErrorCode ParseStl(const char *bytes, size_t length, EqmSerialMesh *mesh, char *error, size_t error_length)
{
  EqmInput in;
  EqmBuilder builder;

  EqmInputOpen(&in, bytes, length, error, error_length);
  EqmBuilderOpen(&builder, &in);
  return EqmBuilderFinish(&builder, ParseMesh(&in, &builder), mesh);
}

/* The points of a triangle's corners, on rank 0. */
static void TakeCorners(EqmMeshStream *stream, PetscInt cell, float x[9])
{
  if (stream->corner_points) {
    memcpy(x, EqmColumnRow(&stream->columns[EQM_COLUMN_CORNERS], cell), 9 * sizeof(float));
    return;
  }
  for (PetscInt k = 0; k < 9; ++k) x[k] = (float)EqmStreamVertex(stream, EqmStreamCell(stream, cell)[k / 3])[k % 3];
}

/* Write a binary STL file. See EqmStreamWriter. The format has single precision and no vertices of its own. */
static PetscErrorCode WriteStl(EqmAtomicFile *file, EqmMeshStream *stream, char *error, size_t error_length)
{
  const char header[HEADER_BYTES] = "equimap binary STL";
  const uint32_t num_triangles = (uint32_t)stream->mesh.num_cells;

  EqmTry(EqmRequireTriangles(&stream->mesh, "STL", error, error_length));
  EqmAtomicWrite(file, header, sizeof(header));
  EqmAtomicWrite(file, &num_triangles, sizeof(num_triangles));
  for (PetscInt i = 0; i < stream->mesh.num_cells; ++i) {
    float triangle[12] = {0}; /* a normal of zero: to be computed by who needs it */

    TakeCorners(stream, i, triangle + 3);
    EqmAtomicWrite(file, triangle, sizeof(triangle));
    EqmAtomicWrite(file, "\0", 2);
  }
  return 0;
}

EQM_DEFINE_FORMAT(Stl) = {.name = "STL",
                          .suffixes = "stl",
                          .recognise = RecogniseStl,
                          .by_length = PETSC_TRUE,
                          .parse = ParseStl,
                          .parse_part = EqmStlParsePart,
                          .write_stream = WriteStl,
                          .writes_corners = PETSC_TRUE};
