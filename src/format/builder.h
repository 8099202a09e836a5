/* The mesh that a parser makes: it grows as the file is read, and is checked and completed at the end. */
#ifndef EQM_FORMAT_BUILDER_H
#define EQM_FORMAT_BUILDER_H

#include <equimap/soup.h>
#include "input.h"

/* Cells of one size, in an array that grows. */
typedef struct {
  size_t count, capacity; /* cells */
  PetscInt *corners;      /* cell size * capacity */
  size_t num_rows, row_capacity;
  PetscInt64 *row; /* per cell, the row of cell fields that belongs to it; NULL: the file has none */
} EqmCellList;

/* A field as the file has it: one row per vertex, or rows that cells name (EqmBuilderSetRow). */
typedef struct {
  EqmMeshField field;
  size_t num_rows;
} EqmRawField;

/* A face of more than three corners, which is cut into triangles when all vertices are known. */
typedef struct {
  size_t first_triangle; /* of num_corners - 2 triangles that follow each other */
  size_t first_corner;   /* in the list of corners of all polygons */
  PetscInt num_corners;
} EqmPolygon;

typedef struct {
  EqmInput *in;                                  /* for messages */
  size_t vertices_before, texture_points_before; /* of a part of a file: those of the parts before it */
  PetscBool texture_of_part; /* corners number the texture points of their part, not those of the file */
  size_t num_vertices, vertex_capacity;
  PetscReal *vertices; /* 3 * vertex_capacity */
  EqmCellList triangles, tetrahedra;
  size_t num_polygons, polygon_capacity;
  EqmPolygon *polygons;
  EqmCellList polygon_corners;            /* vertex, texture point (-1: none); cell size 2 */
  size_t num_textured, textured_capacity; /* triangles; the first ones of the list */
  PetscInt *textured;                     /* 3 per triangle: texture point of each corner, -1: none */
  size_t num_texture_points, texture_capacity;
  PetscReal *texture_points; /* 2 * texture_capacity */
  size_t num_face_corners, face_capacity;
  PetscInt64 *face;                    /* vertex and texture point of each corner of the face being read */
  PetscBool has_rows, rows_are_groups; /* cells have rows; these are the numbers of groups */
  PetscInt64 row;                      /* of cell fields, for the cells that come next */
  PetscInt num_fields;
  EqmRawField *fields;
  char left[EQM_SOUP_NOTE];                   /* what of the file is left out */
  char other_surface[160], other_volume[160]; /* the first cell of another shape: what it is and where; "" if none */
} EqmBuilder;

PETSC_INTERN void EqmBuilderOpen(EqmBuilder *builder, EqmInput *in);
PETSC_INTERN PetscErrorCode EqmBuilderAddVertices(EqmBuilder *builder, size_t count, PetscReal **vertices);
PETSC_INTERN PetscErrorCode EqmBuilderAddTexturePoints(EqmBuilder *builder, size_t count, PetscReal **points);
PETSC_INTERN PetscErrorCode EqmBuilderAddCells(EqmBuilder *builder, PetscInt cell_size, size_t count, PetscInt **cells);
PETSC_INTERN void EqmBuilderStartFace(EqmBuilder *builder);
PETSC_INTERN PetscErrorCode EqmBuilderAddCorner(EqmBuilder *builder, PetscInt64 vertex, PetscInt64 texture);
PETSC_INTERN PetscErrorCode EqmBuilderEndFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices);
PETSC_INTERN PetscErrorCode EqmBuilderAddFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                              PetscInt64 num_corners, const PetscInt64 *corners);
PETSC_INTERN PetscErrorCode EqmBuilderAddStrip(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                               PetscInt64 num_corners, const PetscInt64 *corners);
PETSC_INTERN void EqmBuilderNoteOther(EqmBuilder *builder, PetscInt dimension, const char *position, const char *what);
PETSC_INTERN PetscErrorCode EqmBuilderGrow(EqmInput *in, size_t row_bytes, size_t count, size_t more, size_t *capacity,
                                           void *array);
PETSC_INTERN PetscErrorCode EqmBuilderCutPolygons(EqmBuilder *builder, const PetscReal *corners);
PETSC_INTERN void EqmBuilderSetRow(EqmBuilder *builder, PetscInt64 row);
PETSC_INTERN void EqmBuilderSetGroup(EqmBuilder *builder, PetscInt64 group);
PETSC_INTERN PetscErrorCode EqmBuilderAddField(EqmBuilder *builder, const char *name, size_t name_length,
                                               PetscBool on_cells, PetscInt64 width, size_t num_rows,
                                               PetscReal **values);
PETSC_INTERN PetscErrorCode EqmBuilderDropField(EqmBuilder *builder);
PETSC_INTERN void EqmBuilderNoteLeft(EqmBuilder *builder, const char *what);
PETSC_INTERN PetscErrorCode EqmBuilderTakeFields(EqmBuilder *builder, EqmSerialMesh *mesh, const EqmCellList *cells,
                                                 PetscBool has_groups);
PETSC_INTERN PetscBool EqmBuilderHasGroups(const EqmCellList *cells);
PETSC_INTERN PetscErrorCode EqmBuilderFinish(EqmBuilder *builder, PetscErrorCode code, EqmSerialMesh *mesh);
PETSC_INTERN PetscErrorCode EqmBuilderFinishPart(EqmBuilder *builder, MPI_Comm comm, PetscBool *understood,
                                                 EqmSerialMesh *part);

#endif
