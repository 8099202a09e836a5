/* The mesh that a parser is making: grows as the file goes on, and knows at the end whether it can be mapped. */
#ifndef EQM_FORMAT_BUILDER_H
#define EQM_FORMAT_BUILDER_H

#include <equimap/soup.h>
#include "input.h"

/* Cells of one size, in an array that grows. */
typedef struct {
  size_t count, capacity; /* cells */
  PetscInt *corners;      /* cell size * capacity */
} EqmCellList;

typedef struct {
  EqmInput *in; /* for messages */
  size_t num_vertices, vertex_capacity;
  PetscReal *vertices; /* 3 * vertex_capacity */
  EqmCellList triangles, tetrahedra;
  char other_surface[160], other_volume[160]; /* the first cell of another shape: what it is and where; "" if none */
} EqmBuilder;

PETSC_INTERN void EqmBuilderOpen(EqmBuilder *builder, EqmInput *in);
PETSC_INTERN PetscErrorCode EqmBuilderAddVertices(EqmBuilder *builder, size_t count, PetscReal **vertices);
PETSC_INTERN PetscErrorCode EqmBuilderAddCells(EqmBuilder *builder, PetscInt cell_size, size_t count, PetscInt **cells);
PETSC_INTERN PetscErrorCode EqmBuilderAddFace(EqmBuilder *builder, const char *position, PetscInt64 num_vertices,
                                              PetscInt64 num_corners, const PetscInt64 corners[3]);
PETSC_INTERN void EqmBuilderNoteOther(EqmBuilder *builder, PetscInt dimension, const char *position, const char *what);
PETSC_INTERN PetscErrorCode EqmBuilderFinish(EqmBuilder *builder, PetscErrorCode code, EqmSerialMesh *mesh);

#endif
