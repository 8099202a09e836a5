/* LU of matrices that are not symmetric. On several ranks a system of moderate size visits rank 0 for the time of the
   call: such systems are rare and scalar, and a sequential factorisation gives the same bits in every run. Larger ones
   stay where they are. */
#include "linalg/linalg.h"
#include <petscksp.h>

struct _p_EqmLu {
  MPI_Comm comm;
  PetscMPIInt rank, size;
  PetscBool on_one;      /* rank 0 factors and solves alone; else the solver is all ranks' */
  PetscBool gathers;     /* and has to gather the matrix */
  Mat matrix, *gathered; /* the whole matrix on rank 0; the matrix itself if there is only that */
  IS all;                /* rows that this rank gathers */
  VecScatter to_zero;
  Vec b, x; /* on rank 0 */
  KSP ksp;  /* rank 0's own, or all ranks' */
};

/* MUMPS, with the diagonal as pivots. */
static PetscErrorCode CreateKsp(const char *prefix, Mat matrix, KSP *ksp)
{
  Mat factor;
  PC pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)matrix), ksp));
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

/* The means to bring a system to rank 0. */
static PetscErrorCode SetUpGathering(EqmLu lu, PetscInt num_rows)
{
  Vec like;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(lu->matrix, &like, NULL));
  PetscCall(VecScatterCreateToZero(like, &lu->to_zero, &lu->b));
  PetscCall(VecDuplicate(lu->b, &lu->x));
  PetscCall(VecDestroy(&like));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, lu->rank == 0 ? num_rows : 0, 0, 1, &lu->all));
  if (lu->gathers)
    PetscCall(MatCreateSubMatrices(lu->matrix, lu->rank == 0, &lu->all, &lu->all, MAT_INITIAL_MATRIX, &lu->gathered));
  PetscFunctionReturn(0);
}

/* For a matrix whose diagonal dominates by rows, so that it serves as pivots; its values may change, its pattern not.
   Option: -linear_gather. Collective. */
PetscErrorCode EqmLuCreate(Mat matrix, const char *prefix, EqmLu *out)
{
  EqmLu lu;
  PetscInt num_rows, most = EQM_MOST_ON_ONE_RANK;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lu));
  lu->comm = PetscObjectComm((PetscObject)matrix);
  lu->matrix = matrix;
  PetscCallMPI(MPI_Comm_rank(lu->comm, &lu->rank));
  PetscCallMPI(MPI_Comm_size(lu->comm, &lu->size));
  PetscCall(MatGetSize(matrix, &num_rows, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-linear_gather", &most, NULL));
  lu->on_one = (PetscBool)(lu->size == 1 || num_rows <= most);
  lu->gathers = (PetscBool)(lu->on_one && lu->size > 1);
  if (lu->on_one) PetscCall(SetUpGathering(lu, num_rows));
  if (!lu->on_one || lu->rank == 0) PetscCall(CreateKsp(prefix, lu->gathers ? lu->gathered[0] : matrix, &lu->ksp));
  *out = lu;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmLuDestroy(EqmLu *lu)
{
  PetscFunctionBegin;
  if (!*lu) PetscFunctionReturn(0);
  PetscCall(KSPDestroy(&(*lu)->ksp));
  if ((*lu)->gathers) PetscCall(MatDestroySubMatrices((*lu)->rank == 0, &(*lu)->gathered));
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
  if (lu->gathers)
    PetscCall(MatCreateSubMatrices(lu->matrix, lu->rank == 0, &lu->all, &lu->all, MAT_REUSE_MATRIX, &lu->gathered));
  if (lu->ksp) {
    const Mat matrix = lu->gathers ? lu->gathered[0] : lu->matrix;
    PetscCall(KSPSetOperators(lu->ksp, matrix, matrix));
  }
  PetscFunctionReturn(0);
}

/* On rank 0. */
static PetscErrorCode SolveOnOne(EqmLu lu, Vec b, Vec x, PetscMPIInt *reason)
{
  KSPConvergedReason mine = KSP_CONVERGED_ITERATING;

  PetscFunctionBegin;
  PetscCall(VecScatterBegin(lu->to_zero, b, lu->b, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(lu->to_zero, b, lu->b, INSERT_VALUES, SCATTER_FORWARD));
  if (lu->rank == 0) {
    PetscCall(KSPSolve(lu->ksp, lu->b, lu->x));
    PetscCall(KSPGetConvergedReason(lu->ksp, &mine));
  }
  *reason = (PetscMPIInt)mine;
  PetscCallMPI(MPI_Bcast(reason, 1, MPI_INT, 0, lu->comm));
  PetscCall(VecScatterBegin(lu->to_zero, lu->x, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(lu->to_zero, lu->x, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(0);
}

/* x = A^-1 b; a matrix that cannot be factored is an error on every rank. Collective. */
PetscErrorCode EqmLuSolve(EqmLu lu, Vec b, Vec x)
{
  PetscMPIInt code;

  PetscFunctionBegin;
  if (lu->on_one) {
    PetscCall(SolveOnOne(lu, b, x, &code));
  } else {
    KSPConvergedReason reason;
    PetscCall(KSPSolve(lu->ksp, b, x));
    PetscCall(KSPGetConvergedReason(lu->ksp, &reason));
    code = (PetscMPIInt)reason;
  }
  PetscCheck(code > 0, lu->comm, PETSC_ERR_NOT_CONVERGED, "a system that is not symmetric could not be solved: %s",
             KSPConvergedReasons[code]);
  PetscFunctionReturn(0);
}
