/* Cells as all VTK formats have them: types, offsets, connectivity. */
#ifndef EQM_FORMAT_VTKCELLS_H
#define EQM_FORMAT_VTKCELLS_H

#include "builder.h"

typedef struct {
  PetscInt64 num_cells, num_corners;
  PetscInt64 *end;      /* num_cells: where the corners of a cell end; they begin where those of the cell before end */
  PetscInt64 *corners;  /* num_corners */
  PetscInt64 *type;     /* num_cells; NULL: all are polygons, or triangle strips */
  PetscInt64 first_row; /* of the cell fields: that of the first cell */
  PetscBool strips;
} EqmVtkCells;

PETSC_INTERN PetscErrorCode EqmBuilderAddVtkCells(EqmBuilder *builder, const EqmVtkCells *cells,
                                                  PetscInt64 first_vertex, PetscInt64 num_vertices);
PETSC_INTERN PetscErrorCode EqmVtkCellsReset(EqmVtkCells *cells);

#endif
