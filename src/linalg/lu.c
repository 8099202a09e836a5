/* LU of matrices that are not symmetric. On several ranks the system visits rank 0 for the time of the call: such
   systems are rare and scalar, and a sequential factorisation gives the same bits in every run. */
#include "linalg/linalg.h"
#include <petscksp.h>

struct _p_EqmLu {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  Mat matrix, *gathered; /* the whole matrix on rank 0; the matrix itself if there is only that */
  IS all;                /* rows that this rank gathers */
  VecScatter to_zero;
  Vec b, x; /* on rank 0 */
  KSP ksp;  /* rank 0's own */
};

/* MUMPS, with the diagonal as pivots. */
static PetscErrorCode CreateKsp(const char *prefix, Mat matrix, KSP *ksp)
{
  Mat factor;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_SELF, ksp));
  PetscCall(KSPSetType(*ksp, KSPPREONLY));
  PetscCall(KSPSetOperators(*ksp, matrix, matrix));
  PetscCall(KSPGetPC(*ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &factor));
  PetscCall(MatMumpsSetCntl(factor, 1, 0.)); /* other pivots fill without end */
  PetscCall(KSPSetOptionsPrefix(*ksp, prefix));
  PetscCall(KSPSetFromOptions(*ksp));
  PetscFunctionReturn(0);
}

/* For a matrix whose diagonal dominates by rows, so that it serves as pivots; its values may change, its pattern not.
   Collective. */
PetscErrorCode EqmLuCreate(Mat matrix, const char *prefix, EqmLu *out)
{
  EqmLu lu;
  PetscInt num_rows;
  Vec like;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lu));
  lu->comm = PetscObjectComm((PetscObject)matrix);
  lu->matrix = matrix;
  PetscCallMPI(MPI_Comm_rank(lu->comm, &lu->rank));
  PetscCallMPI(MPI_Comm_size(lu->comm, &lu->size));
  PetscCall(MatGetSize(matrix, &num_rows, NULL));
  PetscCall(MatCreateVecs(matrix, &like, NULL));
  PetscCall(VecScatterCreateToZero(like, &lu->to_zero, &lu->b));
  PetscCall(VecDuplicate(lu->b, &lu->x));
  PetscCall(VecDestroy(&like));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, lu->rank == 0 ? num_rows : 0, 0, 1, &lu->all));
  if (lu->size > 1) {
    PetscCall(MatCreateSubMatrices(matrix, lu->rank == 0, &lu->all, &lu->all, MAT_INITIAL_MATRIX, &lu->gathered));
  }
  if (lu->rank == 0) PetscCall(CreateKsp(prefix, lu->size > 1 ? lu->gathered[0] : matrix, &lu->ksp));
  *out = lu;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLuDestroy(EqmLu *lu)
{
  PetscFunctionBegin;
  if (!*lu) PetscFunctionReturn(0);
  PetscCall(KSPDestroy(&(*lu)->ksp));
  if ((*lu)->size > 1) PetscCall(MatDestroySubMatrices((*lu)->rank == 0, &(*lu)->gathered));
  PetscCall(ISDestroy(&(*lu)->all));
  PetscCall(VecScatterDestroy(&(*lu)->to_zero));
  PetscCall(VecDestroy(&(*lu)->b));
  PetscCall(VecDestroy(&(*lu)->x));
  PetscCall(PetscFree(*lu));
  PetscFunctionReturn(0);
}

/* Take the matrix's present values; the next solve factors them. Collective. */
PetscErrorCode EqmLuRefresh(EqmLu lu)
{
  PetscFunctionBegin;
  if (lu->size > 1) {
    PetscCall(MatCreateSubMatrices(lu->matrix, lu->rank == 0, &lu->all, &lu->all, MAT_REUSE_MATRIX, &lu->gathered));
  }
  if (lu->rank == 0) {
    const Mat matrix = lu->size > 1 ? lu->gathered[0] : lu->matrix;
    PetscCall(KSPSetOperators(lu->ksp, matrix, matrix));
  }
  PetscFunctionReturn(0);
}

/* x = A^-1 b; a matrix that cannot be factored is an error on every rank. Collective. */
PetscErrorCode EqmLuSolve(EqmLu lu, Vec b, Vec x)
{
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscMPIInt code;

  PetscFunctionBegin;
  PetscCall(VecScatterBegin(lu->to_zero, b, lu->b, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(lu->to_zero, b, lu->b, INSERT_VALUES, SCATTER_FORWARD));
  if (lu->rank == 0) {
    PetscCall(KSPSolve(lu->ksp, lu->b, lu->x));
    PetscCall(KSPGetConvergedReason(lu->ksp, &reason));
  }
  code = (PetscMPIInt)reason;
  PetscCallMPI(MPI_Bcast(&code, 1, MPI_INT, 0, lu->comm));
  PetscCheck(code > 0, lu->comm, PETSC_ERR_NOT_CONVERGED, "a system that is not symmetric could not be solved: %s",
             KSPConvergedReasons[code]);
  PetscCall(VecScatterBegin(lu->to_zero, lu->x, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(lu->to_zero, lu->x, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(0);
}
