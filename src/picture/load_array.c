/* Read an array of a result file for a report. */
#include "picture/load.h"

PetscErrorCode EqmLoadReals(EqmH5 h5, const char *path, PetscInt64 width, PetscInt *total, PetscReal **values)
{
  PetscInt64 rows, entries;

  PetscFunctionBegin;
  PetscCall(EqmH5GetShape(h5, path, &rows, &entries));
  if (entries != width || rows > PETSC_MAX_INT / PetscMax(width, 1)) {
    EqmFail(h5->comm, EQM_ERR_IO, "cannot read '%s': %s has an unexpected shape", h5->name, path);
  }
  PetscCall(PetscMalloc1(rows * PetscMax(width, 1), values));
  const EqmSlab slab = {(PetscInt)rows, 0, (PetscInt)rows, (PetscInt)width};
  PetscCall(EqmH5ReadReals(h5, path, slab, *values));
  *total = (PetscInt)rows;
  PetscFunctionReturn(0);
}
