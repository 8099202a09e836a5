/* One face for the direct solvers and multigrid. */
#include "linalg/linalg.h"

const char *const EqmSolverKinds[] = {"auto",      "cholmod",       "substructure", "mumps",
                                      "multigrid", "EqmSolverKind", "EQM_SOLVER_",  NULL};

/* In the plane and on surfaces an exact Cholesky factor beats multigrid at every size that fits in memory; on one rank
   CHOLMOD solves two to three times faster than MUMPS, on several MUMPS is the one that works. */
static PetscErrorCode ChooseKind(EqmLinear linear)
{
  PetscEnum kind = (PetscEnum)EQM_SOLVER_AUTO;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetEnum(NULL, NULL, "-linear_solver", EqmSolverKinds, &kind, NULL));
  linear->kind = (EqmSolverKind)kind;
  if (linear->kind == EQM_SOLVER_AUTO)
    linear->kind = linear->mesh->size == 1 ? EQM_SOLVER_CHOLMOD : EQM_SOLVER_SUBSTRUCTURE;
  if (linear->kind == EQM_SOLVER_CHOLMOD && linear->mesh->size > 1) {
    EqmFail(linear->mesh->comm, EQM_ERR_USAGE,
            "-linear_solver cholmod works on one rank only; on several take mumps or multigrid");
  }
  PetscFunctionReturn(0);
}

/* A solver for matrices with the given unknowns (whose arrays must outlive it). Option: -linear_solver. Collective. */
PetscErrorCode EqmLinearCreate(EqmMesh mesh, EqmOrdering ordering, const EqmUnknowns *unknowns, PetscBool coupled,
                               EqmLinear *out)
{
  EqmLinear linear;

  PetscFunctionBegin;
  PetscCall(PetscNew(&linear));
  linear->mesh = mesh;
  linear->coupled = coupled;
  linear->unknowns = *unknowns;
  linear->num_owned = unknowns->num_owned;
  PetscCall(MPIU_Allreduce(&linear->num_owned, &linear->num_unknowns, 1, MPIU_INT, MPI_SUM, mesh->comm));
  PetscCall(ChooseKind(linear));
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_ASSEMBLE));
  PetscCall(EqmAssemblyCreate(mesh, unknowns, linear->kind == EQM_SOLVER_MULTIGRID ? EQM_STORE_FULL : EQM_STORE_LOWER,
                              &linear->assembly));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_ASSEMBLE));
  switch (linear->kind) {
  case EQM_SOLVER_CHOLMOD:
    PetscCall(EqmLinearSetUpCholmod(linear));
    break;
  case EQM_SOLVER_SUBSTRUCTURE:
    PetscCall(EqmLinearSetUpSubstructure(linear));
    break;
  case EQM_SOLVER_MUMPS:
    PetscCall(EqmLinearSetUpMumps(linear));
    break;
  default:
    PetscCall(EqmLinearSetUpMultigrid(linear));
  }
  PetscCall(linear->analyse(linear, ordering));
  *out = linear;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLinearDestroy(EqmLinear *linear)
{
  PetscFunctionBegin;
  if (!*linear) PetscFunctionReturn(0);
  PetscCall((*linear)->destroy(*linear));
  PetscCall(EqmAssemblyDestroy(&(*linear)->assembly));
  PetscCall(PetscFree(*linear));
  PetscFunctionReturn(0);
}

/* Multiply the diagonal: the smallest shift that makes a singular matrix definite without moving its solution. */
static PetscErrorCode ScaleDiagonal(Mat matrix, PetscReal factor)
{
  Mat diagonal_block;
  const PetscInt *start, *column;
  PetscInt n;
  PetscScalar *value;
  PetscBool done;

  PetscFunctionBegin;
  PetscCall(MatGetDiagonalBlock(matrix, &diagonal_block));
  PetscCall(MatGetRowIJ(diagonal_block, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no access to the rows of a matrix");
  PetscCall(MatSeqAIJGetArray(diagonal_block, &value));
  for (PetscInt i = 0; i < n; i++) {
    PetscInt place;
    PetscCall(PetscFindInt(i, start[i + 1] - start[i], column + start[i], &place));
    if (place >= 0) value[start[i] + place] *= factor;
  }
  PetscCall(MatSeqAIJRestoreArray(diagonal_block, &value));
  PetscCall(MatRestoreRowIJ(diagonal_block, 0, PETSC_FALSE, PETSC_FALSE, &n, &start, &column, &done));
  PetscFunctionReturn(0);
}

/* Assemble the cells' matrices, multiply the diagonal by `diagonal_factor` and factor. `success` is false on every rank
   if the matrix is not numerically positive definite. Counts a factorisation. Collective. */
PetscErrorCode EqmLinearFactor(EqmLinear linear, EqmCellMatrix cell_matrix, void *context, PetscReal diagonal_factor,
                               PetscBool *success)
{
  EqmWork *work;
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(EqmAssemblyFill(linear->assembly, cell_matrix, context));
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  if (diagonal_factor != 1.) PetscCall(ScaleDiagonal(matrix, diagonal_factor));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(linear->factor(linear, success));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  work->factorizations++;
  if (linear->coupled) work->coupled_factorizations++;
  PetscFunctionReturn(0);
}

/* x = A^-1 b for several right-hand sides, stored one after the other, each of this rank's unknowns; x and b may be the
   same array. A solution that is not finite is an error, never an answer. Collective. */
PetscErrorCode EqmLinearSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x)
{
  EqmWork *work;
  PetscReal bad = 0., worst;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(linear->solve(linear, num_rhs, b, x));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  work->solves += num_rhs;
  for (PetscInt k = 0; k < num_rhs * linear->num_owned; k++) {
    if (PetscIsInfOrNanReal(x[k])) bad = 1.;
  }
  PetscCall(MPIU_Allreduce(&bad, &worst, 1, MPIU_REAL, MPIU_MAX, linear->mesh->comm));
  PetscCheck(worst == 0., linear->mesh->comm, PETSC_ERR_FP, "the solution of a linear system is not finite");
  PetscFunctionReturn(0);
}
