/* STL, ASCII and binary. The file repeats a vertex in every triangle; equal coordinates are taken for one vertex,
   numbered in the order of first appearance. */
#include "format.h"
#include "scalar.h"
#include "stl.h"
#include "weld.h"

#include <string.h>

#define HEADER_BYTES EQM_STL_HEADER

/* Does the file's length agree with the number of triangles in a binary header? ASCII files cannot be recognised by
   their first word alone: many binary ones begin with "solid", too. */
PetscBool EqmStlIsBinary(const char *bytes, size_t length)
{
  if (length < HEADER_BYTES + 4) return PETSC_FALSE;
  return (size_t)EqmLoadInteger(bytes + HEADER_BYTES, EQM_SCALAR_UINT32, PETSC_FALSE) * EQM_STL_TRIANGLE ==
                 length - HEADER_BYTES - 4
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscBool EqmStlIsAscii(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipSpace(&in, 0);
  if (!EqmReadKeyword(&in, "solid")) return PETSC_FALSE;
  EqmSkipLine(&in);
  EqmSkipSpace(&in, 0);
  return EqmReadKeyword(&in, "facet") || EqmReadKeyword(&in, "endsolid") ? PETSC_TRUE : PETSC_FALSE;
}

/* "solid" and a facet, or a length that fits a binary header. Not collective. */
static PetscBool RecogniseStl(const char *bytes, size_t length)
{
  return EqmStlIsBinary(bytes, length) || EqmStlIsAscii(bytes, length) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode EqmStlParseTriangles(const char *bytes, size_t num_triangles, EqmBuilder *builder)
{
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(builder, 3 * num_triangles, &x));
  for (size_t t = 0; t < num_triangles; ++t) {
    for (size_t k = 0; k < 9; ++k) { /* after the normal's three numbers */
      x[9 * t + k] = EqmLoadReal(bytes + EQM_STL_TRIANGLE * t + 12 + 4 * k, EQM_SCALAR_FLOAT32, PETSC_FALSE);
    }
  }
  return 0;
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

/* The lines between "facet" and "endfacet". */
static PetscErrorCode ParseFacet(EqmInput *in, EqmBuilder *builder)
{
  const char *position = in->cursor;
  PetscInt num_corners = 0;

  for (EqmSkipLine(in); !EqmReadKeyword(in, "endfacet"); EqmSkipLine(in)) {
    PetscReal *x;

    if (in->cursor == in->end) return EqmReject(in, EQM_ERR_IO, "the file ends inside a facet: it is truncated");
    if (!EqmReadKeyword(in, "vertex")) continue; /* outer loop, endloop */
    EqmTry(EqmBuilderAddVertices(builder, 1, &x));
    ++num_corners;
    for (PetscInt k = 0; k < 3; ++k) {
      if (!EqmReadReal(in, &x[k])) return EqmReject(in, EQM_ERR_IO, "a vertex needs three numbers");
    }
  }
  if (num_corners == 3) return 0;
  return EqmRejectAt(in, position, EQM_ERR_IO, "a facet has %d vertices instead of three", (int)num_corners);
}

PetscErrorCode EqmStlParseFacets(EqmInput *in, EqmBuilder *builder, PetscInt64 *open_solids)
{
  *open_solids = 0;
  EqmSkipSpace(in, 0);
  for (; in->cursor < in->end; EqmSkipLine(in)) {
    if (EqmReadKeyword(in, "facet")) {
      EqmTry(ParseFacet(in, builder));
    } else if (EqmReadKeyword(in, "solid")) {
      ++*open_solids;
    } else if (EqmReadKeyword(in, "endsolid")) {
      --*open_solids;
    } else if (!EqmAtLineEnd(in)) {
      return EqmReject(in, EQM_ERR_IO, "neither a facet nor a solid: this is not an STL file, or a damaged one");
    }
  }
  return 0;
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

/* Write a binary STL file. See EqmWriter. The format has single precision and no vertices of its own. */
static PetscErrorCode WriteStl(EqmAtomicFile *file, const EqmSerialMesh *mesh, const EqmField *fields,
                               PetscInt num_fields, char *error, size_t error_length)
{
  const char header[HEADER_BYTES] = "equimap binary STL";
  const uint32_t num_triangles = (uint32_t)mesh->num_cells;

  EqmTry(EqmRequireTriangles(mesh, "STL", error, error_length));
  EqmAtomicWrite(file, header, sizeof(header));
  EqmAtomicWrite(file, &num_triangles, sizeof(num_triangles));
  for (PetscInt i = 0; i < mesh->num_cells; ++i) {
    float triangle[12] = {0}; /* a normal of zero: to be computed by who needs it */

    for (PetscInt k = 0; k < 9; ++k) {
      const size_t vertex = (size_t)mesh->cells[3 * (size_t)i + (size_t)(k / 3)];

      triangle[3 + k] = (float)mesh->vertices[3 * vertex + (size_t)(k % 3)];
    }
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
                          .write = WriteStl};
