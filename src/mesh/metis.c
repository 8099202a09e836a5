/* METIS's cut of a graph into parts. */
#include "mesh/build.h"
#include <metis.h>

/* Cut a graph into parts of equal size with few edges between them. Not collective. */
PetscErrorCode EqmRunMetis(PetscInt num_parts, PetscInt n, PetscInt *start, PetscInt *neighbor, PetscInt *part)
{
  idx_t num_rows = (idx_t)n, num_constraints = 1, parts = (idx_t)num_parts, cut;
  int result;

  PetscFunctionBegin;
  if (num_parts == 1) { /* METIS divides by zero there */
    PetscCall(PetscArrayzero(part, n));
    PetscFunctionReturn(0);
  }
  PetscCheck(sizeof(idx_t) == sizeof(PetscInt), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "METIS and PETSc were built with integers of different sizes; build both with the same");
  result = METIS_PartGraphKway(&num_rows, &num_constraints, (idx_t *)start, (idx_t *)neighbor, NULL, NULL, NULL, &parts,
                               NULL, NULL, NULL, &cut, (idx_t *)part);
  PetscCheck(result == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS_PartGraphKway failed with code %d", result);
  PetscFunctionReturn(0);
}
