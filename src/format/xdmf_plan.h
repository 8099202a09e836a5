/* What an XDMF file says: which arrays are the mesh and its fields, and where they are. */
#ifndef EQM_FORMAT_XDMF_PLAN_H
#define EQM_FORMAT_XDMF_PLAN_H

#include <equimap/soup.h>

enum { EQM_XDMF_MOST_FIELDS = 64, EQM_XDMF_PATH = 512 };

/* An array, a row per vertex or cell. */
typedef struct {
  PetscInt64 rows, width;
  char file[EQM_XDMF_PATH],
      path[EQM_XDMF_PATH]; /* of the HDF5 file, beside the XDMF file; "": they stand in the text */
  PetscReal *values;       /* those of the text; PetscMalloc'ed, on the rank that has parsed it */
} EqmXdmfArray;

typedef struct {
  PetscInt cell_size;
  EqmXdmfArray points, cells;
  PetscInt num_fields;
  EqmXdmfArray field[EQM_XDMF_MOST_FIELDS];
  char name[EQM_XDMF_MOST_FIELDS][EQM_FIELD_NAME];
  PetscBool on_cells[EQM_XDMF_MOST_FIELDS];
} EqmXdmfPlan;

/* Not collective. Errors (quiet): EQM_ERR_IO, EQM_ERR_MESH (other cells than triangles and tetrahedra). */
PETSC_INTERN PetscErrorCode EqmXdmfParse(const char *bytes, size_t length, EqmXdmfPlan *plan, char *error,
                                         size_t error_length);
/* Free the numbers of the text. Not collective. */
PETSC_INTERN PetscErrorCode EqmXdmfReset(EqmXdmfPlan *plan);

#endif
