/* What whole STL files and parts of them share. */
#include "scalar.h"
#include "stl.h"

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
