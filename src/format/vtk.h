/* What the files of the legacy VTK reader share: numbers, and the fields after the mesh. */
#ifndef EQM_FORMAT_VTK_H
#define EQM_FORMAT_VTK_H

#include "scalar.h"
#include "vtkcells.h"

typedef struct {
  EqmInput *in;
  EqmBuilder builder;
  PetscBool ascii, polydata;
  EqmVtkCells cells;   /* of an unstructured grid: its types come later */
  PetscInt64 num_rows; /* of cell fields: all cells so far, those too that are skipped */
} EqmVtk;

PETSC_INTERN PetscErrorCode EqmVtkReadType(EqmInput *in, EqmScalarType *type);
PETSC_INTERN PetscErrorCode EqmVtkCheckRoom(EqmVtk *vtk, EqmScalarType type, PetscInt64 count);
PETSC_INTERN PetscErrorCode EqmVtkReadReals(EqmVtk *vtk, EqmScalarType type, PetscInt64 count, PetscReal *values);
PETSC_INTERN PetscErrorCode EqmVtkReadTwoCounts(EqmVtk *vtk, PetscInt64 *first, PetscInt64 *second);
PETSC_INTERN PetscErrorCode EqmVtkSkipField(EqmVtk *vtk);
PETSC_INTERN void EqmVtkSkipMetadata(EqmInput *in);
PETSC_INTERN PetscErrorCode EqmVtkParseFields(EqmVtk *vtk, PetscBool on_cells);

#endif
