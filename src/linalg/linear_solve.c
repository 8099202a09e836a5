/* Factors and solutions, whatever solves. */
#include "linalg/linalg.h"
#include "mesh/mesh_private.h"

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

/* Assemble the cells' matrices, unless the kind does that itself. */
static PetscErrorCode Assemble(EqmLinear linear)
{
  Mat matrix;

  PetscFunctionBegin;
  if (!linear->assembly) PetscFunctionReturn(0);
  if (linear->padded_cell)
    PetscCall(EqmAssemblyFill(linear->assembly, linear->padded_cell, linear));
  else
    PetscCall(EqmAssemblyFill(linear->assembly, linear->cell_matrix, linear->context));
  PetscCall(EqmAssemblyGetMat(linear->assembly, &matrix));
  if (linear->diagonal_factor != 1.) PetscCall(ScaleDiagonal(matrix, linear->diagonal_factor));
  PetscFunctionReturn(0);
}

/* Assemble the cells' matrices, multiply the diagonal by `diagonal_factor` and factor. `success` is false on every rank
   if the matrix is not numerically positive definite. Counts a factorisation, or a set-up of the hierarchy's levels.
   Collective. */
PetscErrorCode EqmLinearFactor(EqmLinear linear, EqmCellMatrix cell_matrix, void *context, PetscReal diagonal_factor,
                               PetscBool *success)
{
  EqmWork *work;

  PetscFunctionBegin;
  linear->cell_matrix = cell_matrix;
  linear->context = context;
  linear->diagonal_factor = diagonal_factor;
  PetscCall(Assemble(linear));
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(linear->factor(linear, success));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_FACTOR));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  if (linear->kind == EQM_SOLVER_HIERARCHY) {
    work->set_ups++;
  } else {
    work->factorizations++;
    if (linear->use != EQM_MATRIX_SCALAR) work->coupled_factorizations++;
  }
  PetscFunctionReturn(0);
}

/* An iteration that has not converged, which all ranks know of, is an error. */
static PetscErrorCode CheckSuccess(EqmLinear linear, PetscBool success)
{
  PetscFunctionBegin;
  if (!success && linear->kind == EQM_SOLVER_PETSC)
    EqmFail(linear->mesh->comm, EQM_ERR_USAGE,
            "the solver that the options -linear_... describe did not converge; give it more iterations "
            "(-linear_ksp_max_it) or another preconditioner, or leave -linear_solver to the program");
  PetscCheck(
      success, linear->mesh->comm, PETSC_ERR_NOT_CONVERGED,
      "the iteration of -linear_solver %s did not converge: the matrix may not be definite; try -linear_solver %s",
      EqmSolverKinds[linear->kind], linear->mesh->size == 1 ? "multifrontal" : "mumps");
  PetscFunctionReturn(0);
}

/* x = B b with a fixed symmetric definite B near A^-1: the factor's inverse itself, or one multigrid cycle. What turns
   gradients into directions asks for no more, and a truncated iteration would not be linear. Columns as for
   EqmLinearSolve. Collective. */
PetscErrorCode EqmLinearApply(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x)
{
  EqmWork *work;

  PetscFunctionBegin;
  if (!linear->apply) {
    PetscCall(EqmLinearSolve(linear, num_rhs, b, x));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(linear->apply(linear, num_rhs, b, x));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  work->solves += num_rhs;
  PetscFunctionReturn(0);
}

/* x <- A^-1 x as well as a step asks for: one pass with the factor, or an iteration. Not looked at: the caller finds
   out from a product with it whether it is finite, which spares a reduction. Collective. */
PetscErrorCode EqmLinearSolveStep(EqmLinear linear, PetscReal *x)
{
  EqmWork *work;
  PetscBool success = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(linear->solve(linear, 1, x, x, &success));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  work->solves++;
  PetscCall(CheckSuccess(linear, success));
  PetscFunctionReturn(0);
}

/* Steps need no exact solutions: iterations may stop at this reduction of the error's estimate in the energy norm;
   exact factors stay exact. For the factorisations to come. Not collective. */
PetscErrorCode EqmLinearSetInexact(EqmLinear linear, PetscReal tolerance)
{
  PetscFunctionBegin;
  linear->inexact = PETSC_TRUE;
  linear->tolerance = tolerance;
  PetscFunctionReturn(0);
}

/* Shall factorisations to come keep the coarse spaces of the last one? That is far cheaper, and as good where matrices
   change little; but then results depend on the matrices before. Exact factors have none. Not collective. */
PetscErrorCode EqmLinearKeepCoarseSpaces(EqmLinear linear, PetscBool keep)
{
  PetscFunctionBegin;
  linear->keeps_coarse_spaces = keep;
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscBool EqmLinearHasCoarseSpaces(EqmLinear linear)
{
  return (PetscBool)(linear->kind == EQM_SOLVER_MULTIGRID);
}

/* Fields that the matrix hardly sees, columns of this rank's unknowns: coarse grids then hold them. For the
   factorisations to come; exact factors need none. Collective. */
PetscErrorCode EqmLinearSetFields(EqmLinear linear, PetscInt count, const PetscReal *fields)
{
  PetscFunctionBegin;
  if (linear->set_fields) PetscCall(linear->set_fields(linear, count, fields));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLinearSetImage(EqmLinear linear, PetscInt dim, const PetscReal *x, const PetscReal *frame)
{
  PetscFunctionBegin;
  if (linear->set_image) PetscCall(linear->set_image(linear, dim, x, frame));
  PetscFunctionReturn(0);
}

/* x = A^-1 b for several right-hand sides, stored one after the other, each of this rank's unknowns; x and b may be the
   same array. `success` is false on every rank if an iteration has not come to its tolerance, which is how it finds
   that a matrix is not definite. A solution that is not finite is an error, never an answer. Collective. */
PetscErrorCode EqmLinearTrySolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x,
                                 PetscBool *success)
{
  EqmWork *work;
  int bad = 0;

  PetscFunctionBegin;
  *success = PETSC_TRUE;
  PetscCall(EqmEventBegin(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(linear->solve(linear, num_rhs, b, x, success));
  PetscCall(EqmEventEnd(linear->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(EqmLedgerGetWork(linear->mesh->ledger, &work));
  work->solves += num_rhs;
  if (!*success) PetscFunctionReturn(0);
  for (PetscInt k = 0; k < num_rhs * linear->num_owned; k++) bad |= !(PetscAbsReal(x[k]) <= PETSC_MAX_REAL);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPI_INT, MPI_MAX, linear->mesh->comm));
  PetscCheck(bad == 0, linear->mesh->comm, PETSC_ERR_FP, "the solution of a linear system is not finite");
  PetscFunctionReturn(0);
}

/* The same where anything but a solution is an error. Collective. */
PetscErrorCode EqmLinearSolve(EqmLinear linear, PetscInt num_rhs, const PetscReal *b, PetscReal *x)
{
  PetscBool success;

  PetscFunctionBegin;
  PetscCall(EqmLinearTrySolve(linear, num_rhs, b, x, &success));
  PetscCall(CheckSuccess(linear, success));
  PetscFunctionReturn(0);
}
