/* Rows of vertices and cells of Medit's format, of the whole file or of a part. */
#include "medit_part.h"

const EqmMeditKind EqmMeditKinds[EQM_MEDIT_NUM_KINDS] = {
    {"Triangles", 6, 2, 3, PETSC_TRUE},   {"Quadrilaterals", 7, 2, 4, PETSC_TRUE},
    {"Tetrahedra", 8, 3, 4, PETSC_TRUE},  {"Prisms", 9, 3, 6, PETSC_FALSE},
    {"Hexahedra", 10, 3, 8, PETSC_FALSE}, {"TrianglesP2", 24, 2, 6, PETSC_FALSE},
    {"Pyramids", 49, 3, 5, PETSC_FALSE},  {"TetrahedraP2", 30, 3, 10, PETSC_FALSE},
};

PetscBool EqmMeditBegins(const char *bytes, size_t length)
{
  EqmInput in;
  char unused[8];

  EqmInputOpen(&in, bytes, length, unused, sizeof(unused));
  EqmSkipMark(&in);
  EqmSkipSpace(&in, '#');
  return EqmReadKeyword(&in, "MeshVersionFormatted");
}

/* EqmMeditStartCells - `count` cells begin at the cursor; a kind that is not wanted is noted. Not collective. Errors:
   EQM_ERR_IO (quiet) if the vertices are not known yet. */
PetscErrorCode EqmMeditStartCells(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                                  PetscInt64 count)
{
  char what[64];

  if (!kind->wanted) {
    snprintf(what, sizeof(what), "%lld %s", (long long)count, kind->keyword);
    if (count) EqmBuilderNoteOther(builder, kind->dimension, builder->in->cursor, what);
    return 0;
  }
  if (num_vertices || !count) return 0;
  return EqmReject(builder->in, EQM_ERR_IO, "the section %s comes before the section Vertices", kind->keyword);
}

/* EqmMeditAddCell - append a cell of a wanted kind by the file's vertex numbers, which count from 1, and its reference
   number. Not collective. Errors: EQM_ERR_IO (quiet). */
PetscErrorCode EqmMeditAddCell(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                               const PetscInt64 *vertices, PetscInt64 reference)
{
  PetscInt64 corners[EQM_MEDIT_MAX_CORNERS];
  PetscInt *cell;

  for (PetscInt k = 0; k < kind->num_corners; ++k) {
    if (vertices[k] < 1 || vertices[k] > num_vertices) {
      return EqmReject(builder->in, EQM_ERR_IO, "%s: vertex number %lld is out of range 1..%lld", kind->keyword,
                       (long long)vertices[k], (long long)num_vertices);
    }
    corners[k] = vertices[k] - 1;
  }
  EqmBuilderSetGroup(builder, reference);
  if (kind->dimension == 2) return EqmBuilderAddFace(builder, NULL, num_vertices, kind->num_corners, corners);
  EqmTry(EqmBuilderAddCells(builder, kind->num_corners, 1, &cell));
  for (PetscInt k = 0; k < kind->num_corners; ++k) cell[k] = (PetscInt)corners[k];
  return 0;
}

PetscErrorCode EqmMeditReadInteger(EqmInput *in, const char *what, PetscInt64 *value)
{
  EqmSkipSpace(in, '#');
  if (EqmReadInteger(in, value)) return 0;
  return EqmReject(in, EQM_ERR_IO, "%s: a whole number is missing%s", what,
                   in->cursor == in->end ? ": the file is truncated" : "");
}

PetscErrorCode EqmMeditReadVertices(EqmBuilder *builder, PetscInt64 dimension, PetscInt64 count)
{
  EqmInput *const in = builder->in;
  PetscInt64 reference;
  PetscReal *x;

  EqmTry(EqmBuilderAddVertices(builder, (size_t)count, &x));
  for (PetscInt64 i = 0; i < count; ++i) {
    x[3 * i + 2] = 0.0; /* of the plane */
    for (PetscInt64 k = 0; k < dimension; ++k) {
      EqmSkipSpace(in, '#');
      if (!EqmReadReal(in, &x[3 * i + k])) {
        return EqmReject(in, EQM_ERR_IO, "vertex %lld of %lld needs %lld coordinates%s", (long long)i, (long long)count,
                         (long long)dimension, in->cursor == in->end ? ": the file is truncated" : "");
      }
    }
    EqmTry(EqmMeditReadInteger(in, "Vertices", &reference));
  }
  return 0;
}

PetscErrorCode EqmMeditReadCells(EqmBuilder *builder, const EqmMeditKind *kind, PetscInt64 num_vertices,
                                 PetscInt64 count)
{
  PetscInt64 reference, corners[EQM_MEDIT_MAX_CORNERS];

  for (PetscInt64 i = 0; i < count; ++i) {
    for (PetscInt k = 0; k < kind->num_corners; ++k)
      EqmTry(EqmMeditReadInteger(builder->in, kind->keyword, &corners[k]));
    EqmTry(EqmMeditReadInteger(builder->in, kind->keyword, &reference));
    EqmTry(EqmMeditAddCell(builder, kind, num_vertices, corners, reference));
  }
  return 0;
}
