#include "vtkcells.h"

#include <stdio.h>

enum { VTK_TRIANGLE = 5, VTK_STRIP = 6, VTK_POLYGON = 7, VTK_PIXEL = 8, VTK_QUAD = 9, VTK_TETRA = 10 };

/* Dimension of a VTK cell type; 0 for points and for unknown types without corners. */
static PetscInt DimensionOf(PetscInt64 type)
{
  static const int curves[] = {3, 4, 21, 35, 68, 75};
  static const int surfaces[] = {5, 6, 7, 8, 9, 22, 23, 28, 30, 34, 36, 69, 70, 76, 77};

  if (type <= 2) return 0;
  for (size_t i = 0; i < sizeof(curves) / sizeof(curves[0]); ++i) {
    if (type == curves[i]) return 1;
  }
  for (size_t i = 0; i < sizeof(surfaces) / sizeof(surfaces[0]); ++i) {
    if (type == surfaces[i]) return 2;
  }
  return 3;
}

/* A face of any number of corners, a strip, or a pixel, whose last two corners are exchanged. */
static PetscErrorCode AddFace(EqmBuilder *builder, PetscInt64 type, PetscInt64 num_corners, const PetscInt64 *corners,
                              PetscInt64 first_vertex, PetscInt64 num_vertices)
{
  PetscInt64 *shifted;
  PetscErrorCode code;

  EqmTry(PetscMalloc1(num_corners + 1, &shifted));
  for (PetscInt64 k = 0; k < num_corners; ++k) {
    shifted[k] = corners[type == VTK_PIXEL ? k ^ (k >> 1) : k] + first_vertex;
  }
  if (type == VTK_STRIP) {
    code = EqmBuilderAddStrip(builder, NULL, first_vertex + num_vertices, num_corners, shifted);
  } else {
    code = EqmBuilderAddFace(builder, NULL, first_vertex + num_vertices, num_corners, shifted);
  }
  EqmTry(PetscFree(shifted));
  return code;
}

/* A face or a tetrahedron, whose corners are checked; other cells are noted or skipped. */
static PetscErrorCode AddCell(EqmBuilder *builder, PetscInt64 cell, PetscInt64 type, PetscInt64 num_corners,
                              const PetscInt64 *corners, PetscInt64 first_vertex, PetscInt64 num_vertices)
{
  const PetscInt64 needed = type == VTK_TRIANGLE ? 3 : type >= VTK_PIXEL && type <= VTK_TETRA ? 4 : 0;
  PetscInt *out;
  char what[96];

  if (needed && num_corners != needed) {
    return EqmRejectAt(builder->in, NULL, EQM_ERR_IO, "cell %lld of VTK type %lld has %lld corners", (long long)cell,
                       (long long)type, (long long)num_corners);
  }
  for (PetscInt64 k = 0; k < num_corners && type <= VTK_TETRA; ++k) {
    if (corners[k] < 0 || corners[k] >= num_vertices) {
      return EqmRejectAt(builder->in, NULL, EQM_ERR_IO, "cell %lld: vertex index %lld is out of range 0..%lld",
                         (long long)cell, (long long)corners[k], (long long)num_vertices - 1);
    }
  }
  if (type >= VTK_TRIANGLE && type <= VTK_QUAD)
    return AddFace(builder, type, num_corners, corners, first_vertex, num_vertices);
  if (type != VTK_TETRA) {
    if (DimensionOf(type) < 2) return 0;
    snprintf(what, sizeof(what), "cell %lld has the VTK type %lld and %lld corners", (long long)cell, (long long)type,
             (long long)num_corners);
    EqmBuilderNoteOther(builder, DimensionOf(type), NULL, what);
    return 0;
  }
  EqmTry(EqmBuilderAddCells(builder, 4, 1, &out));
  for (PetscInt k = 0; k < 4; ++k) out[k] = (PetscInt)(corners[k] + first_vertex);
  return 0;
}

/* EqmBuilderAddVtkCells - append the faces and tetrahedra among the cells. Not collective. `num_vertices` is what
   the corners may name, `first_vertex` the number that their vertex 0 has in the whole mesh. Errors: EQM_ERR_IO
   (quiet). */
PetscErrorCode EqmBuilderAddVtkCells(EqmBuilder *builder, const EqmVtkCells *cells, PetscInt64 first_vertex,
                                     PetscInt64 num_vertices)
{
  PetscInt64 begin = 0;

  EqmBuilderSetRow(builder, cells->first_row); /* a part of a file may have rows and no cell */
  for (PetscInt64 i = 0; i < cells->num_cells; ++i) {
    const PetscInt64 end = cells->end[i];

    if (end < begin || end > cells->num_corners) {
      return EqmRejectAt(builder->in, NULL, EQM_ERR_IO, "cell %lld: its offset %lld is out of range %lld..%lld",
                         (long long)i, (long long)end, (long long)begin, (long long)cells->num_corners);
    }
    EqmBuilderSetRow(builder, cells->first_row + i);
    EqmTry(AddCell(builder, i,
                   cells->type     ? cells->type[i]
                   : cells->strips ? VTK_STRIP
                                   : VTK_POLYGON,
                   end - begin, cells->corners + begin, first_vertex, num_vertices));
    begin = end;
  }
  return 0;
}

/* EqmVtkCellsReset - free everything. Not collective. */
PetscErrorCode EqmVtkCellsReset(EqmVtkCells *cells)
{
  EqmTry(PetscFree(cells->end));
  EqmTry(PetscFree(cells->corners));
  EqmTry(PetscFree(cells->type));
  *cells = (EqmVtkCells){0};
  return 0;
}
