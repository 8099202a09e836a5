/* How CHOLMOD sees an assembled matrix, and what its factors take. Our lower triangle by rows is the upper triangle by
   columns that CHOLMOD reads in place. */
#include "linalg/cholmod_name.h"

PetscErrorCode EqmCholmodGetView(EqmLinear linear, cholmod_sparse *view)
{
  const PetscInt *start, *column;
  PetscScalar *value;
  PetscInt n;
  PetscBool done;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatGetRowIJ(matrix, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no access to the rows of a matrix");
  PetscCall(MatSeqAIJGetArray(matrix, &value));
  *view = (cholmod_sparse){.nrow = (size_t)n,
                           .ncol = (size_t)n,
                           .nzmax = (size_t)start[n],
                           .p = (void *)start,
                           .i = (void *)column,
                           .x = value,
                           .stype = 1,
                           .itype = sizeof(PetscInt) == sizeof(int) ? CHOLMOD_INT : CHOLMOD_LONG,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE,
                           .sorted = 1,
                           .packed = 1};
  PetscFunctionReturn(0);
}

PetscErrorCode EqmCholmodRestoreView(EqmLinear linear, cholmod_sparse *view)
{
  const PetscInt *start = view->p, *column = view->i;
  PetscScalar *value = view->x;
  PetscInt n = (PetscInt)view->nrow;
  PetscBool done;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  PetscCall(MatSeqAIJRestoreArray(matrix, &value));
  PetscCall(MatRestoreRowIJ(matrix, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmOrderingOfFactor(EqmLinear linear, EqmOrdering ordering, PetscInt **order)
{
  PetscInt *position;

  PetscFunctionBegin;
  PetscCall(EqmOrderingOfUnknowns(ordering, &linear->unknowns, &position));
  PetscCall(PetscMalloc1(linear->num_unknowns, order));
  for (PetscInt k = 0; k < linear->num_unknowns; k++) (*order)[position[k]] = k;
  PetscCall(PetscFree(position));
  PetscFunctionReturn(0);
}

void EqmEstimateCholmod(const cholmod_factor *factor, const cholmod_common *common, EqmEstimate *estimate)
{
  enum { VECTORS = 12 }; /* three right-hand sides, their solutions and CHOLMOD's work spaces */

  estimate->nonzeros += common->lnz;
  estimate->flops += common->fl;
  estimate->bytes_on_rank += (PetscReal)sizeof(PetscScalar) * ((PetscReal)factor->xsize + (PetscReal)factor->maxcsize +
                                                               VECTORS * (PetscReal)factor->n) +
                             (PetscReal)sizeof(PetscInt) * (PetscReal)factor->ssize +
                             2. * (PetscReal)(sizeof(PetscScalar) + sizeof(PetscInt)) * common->anz;
}
