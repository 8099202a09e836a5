/* Square matrices of meshes that are not positive definite: L D L^T with pivots where they are symmetric, else L U, by
   MUMPS through PETSc. The symbolic part is done once. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"

struct _p_EqmGeneral {
  EqmMesh mesh;
  PetscBool symmetric, coupled, analysed;
  PetscInt num_owned;
  EqmAssembly assembly;
  Mat factor;
};

PetscErrorCode EqmGeneralCreate(EqmMesh mesh, const EqmUnknowns *unknowns, PetscBool symmetric, PetscBool coupled,
                                EqmGeneral *out)
{
  EqmGeneral general;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(PetscNew(&general));
  general->mesh = mesh;
  general->symmetric = symmetric;
  general->coupled = coupled;
  general->num_owned = unknowns->num_owned;
  PetscCall(EqmAssemblyCreate(mesh, unknowns, EQM_STORE_FULL, &general->assembly));
  PetscCall(EqmAssemblyGetMat(general->assembly, &matrix));
  PetscCall(MatSetOption(matrix, MAT_SYMMETRIC, symmetric));
  PetscCall(MatGetFactor(matrix, MATSOLVERMUMPS, symmetric ? MAT_FACTOR_CHOLESKY : MAT_FACTOR_LU, &general->factor));
  *out = general;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGeneralDestroy(EqmGeneral *general)
{
  PetscFunctionBegin;
  if (!*general) PetscFunctionReturn(0);
  PetscCall(MatDestroy(&(*general)->factor));
  PetscCall(EqmAssemblyDestroy(&(*general)->assembly));
  PetscCall(PetscFree(*general));
  PetscFunctionReturn(0);
}

/* The symbolic part at the first call, the numerical one at every call. */
static PetscErrorCode Factor(EqmGeneral general, Mat matrix)
{
  PetscBool first = (PetscBool)!general->analysed;
  MatFactorInfo info;

  PetscFunctionBegin;
  PetscCall(MatFactorInfoInitialize(&info));
  general->analysed = PETSC_TRUE;
  if (general->symmetric) {
    if (first) PetscCall(MatCholeskyFactorSymbolic(general->factor, matrix, NULL, &info));
    PetscCall(MatCholeskyFactorNumeric(general->factor, matrix, &info));
  } else {
    if (first) PetscCall(MatLUFactorSymbolic(general->factor, matrix, NULL, NULL, &info));
    PetscCall(MatLUFactorNumeric(general->factor, matrix, &info));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGeneralFactor(EqmGeneral general, EqmCellMatrix cell_matrix, void *context, PetscReal shift,
                                PetscBool *success)
{
  EqmWork *work;
  MatFactorError error;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyFill(general->assembly, cell_matrix, context));
  PetscCall(EqmAssemblyGetMat(general->assembly, &matrix));
  PetscCall(MatShift(matrix, shift));
  PetscCall(EqmEventBegin(general->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(Factor(general, matrix));
  PetscCall(EqmEventEnd(general->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(MatFactorGetError(general->factor, &error));
  PetscCheck(error != MAT_FACTOR_OUTMEMORY, general->mesh->comm, PETSC_ERR_MEM,
             "a factorisation ran out of memory: use more ranks or nodes");
  *success = (PetscBool)(error == MAT_FACTOR_NOERROR);
  PetscCall(EqmLedgerGetWork(general->mesh->ledger, &work));
  work->factorizations++;
  if (general->coupled) work->coupled_factorizations++;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGeneralSolve(EqmGeneral general, PetscInt num_rhs, PetscReal *columns)
{
  const PetscInt n = general->num_owned;
  PetscReal *solution, bad = 0., worst;
  EqmWork *work;
  Mat b, x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(num_rhs * n + 1, &solution));
  PetscCall(MatCreateDense(general->mesh->comm, n, PETSC_DECIDE, PETSC_DETERMINE, num_rhs, columns, &b));
  PetscCall(MatCreateDense(general->mesh->comm, n, PETSC_DECIDE, PETSC_DETERMINE, num_rhs, solution, &x));
  PetscCall(EqmEventBegin(general->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(MatMatSolve(general->factor, b, x));
  PetscCall(EqmEventEnd(general->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmLedgerGetWork(general->mesh->ledger, &work));
  work->solves += num_rhs;
  for (PetscInt k = 0; k < num_rhs * n; k++) {
    columns[k] = solution[k];
    if (PetscIsInfOrNanReal(solution[k])) bad = 1.;
  }
  PetscCall(MatDestroy(&b));
  PetscCall(MatDestroy(&x));
  PetscCall(PetscFree(solution));
  PetscCall(MPIU_Allreduce(&bad, &worst, 1, MPIU_REAL, MPIU_MAX, general->mesh->comm));
  PetscCheck(worst == 0., general->mesh->comm, PETSC_ERR_FP, "the solution of a linear system is not finite");
  PetscFunctionReturn(0);
}
