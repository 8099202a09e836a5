/* Lanczos on the inverse of H - shift, whose largest eigenvalues are 1 / (lambda - shift). */
#include "solver/lanczos.h"
#include "mesh/mesh_private.h"
#ifdef EQM_HAVE_SLEPC
#include <slepceps.h>

typedef struct {
  EqmApplyShifted apply;
  void *context;
} Inverse;

static PetscErrorCode Multiply(Mat matrix, Vec x, Vec y)
{
  Inverse *inverse;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &inverse));
  PetscCall(inverse->apply(inverse->context, x, y));
  PetscFunctionReturn(0);
}

static PetscErrorCode CreateMatrix(MPI_Comm comm, Vec like, Inverse *inverse, Mat *matrix)
{
  PetscInt local, total;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(like, &local));
  PetscCall(VecGetSize(like, &total));
  PetscCall(MatCreateShell(comm, local, local, total, total, inverse, matrix));
  PetscCall(MatShellSetOperation(*matrix, MATOP_MULT, (void (*)(void))Multiply));
  PetscFunctionReturn(0);
}

/* Near a minimum the eigenvalues crowd: a basis of more than twice as many. */
PetscErrorCode EqmLanczos(MPI_Comm comm, EqmApplyShifted apply, void *context, Vec like, PetscReal shift,
                          PetscInt wanted, PetscReal *values, PetscInt *found)
{
  Inverse inverse = {apply, context};
  PetscInt total;
  Mat matrix;
  EPS eps;

  PetscFunctionBegin;
  if (!SlepcInitializeCalled) PetscCall(SlepcInitializeNoArguments());
  PetscCall(VecGetSize(like, &total));
  PetscCall(CreateMatrix(comm, like, &inverse, &matrix));
  PetscCall(EPSCreate(comm, &eps));
  PetscCall(EPSSetOptionsPrefix(eps, "hessian_"));
  PetscCall(EPSSetOperators(eps, matrix, NULL));
  PetscCall(EPSSetProblemType(eps, EPS_HEP));
  PetscCall(EPSSetWhichEigenpairs(eps, EPS_LARGEST_REAL));
  PetscCall(EPSSetDimensions(eps, wanted, PetscMin(total, 2 * wanted + 60), PETSC_DEFAULT));
  PetscCall(EPSSetTolerances(eps, 1e-7, 300));
  PetscCall(EPSSetFromOptions(eps));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, found));
  *found = PetscMin(*found, wanted);
  for (PetscInt k = 0; k < *found; k++) {
    PetscScalar theta;
    PetscCall(EPSGetEigenvalue(eps, k, &theta, NULL));
    values[k] = shift + 1. / theta;
  }
  PetscCall(EPSDestroy(&eps));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(0);
}
#else
PetscErrorCode EqmLanczos(MPI_Comm comm, EqmApplyShifted apply, void *context, Vec like, PetscReal shift,
                          PetscInt wanted, PetscReal *values, PetscInt *found)
{
  PetscFunctionBegin;
  PetscCall(EqmLanczosCheck(comm, wanted, wanted, found));
  (void)apply, (void)context, (void)like, (void)shift, (void)values;
  PetscFunctionReturn(0);
}
#endif

/* EqmHessianAvailable - can eigenvalues of the Hessian be computed, that is, was the library built with SLEPc?

   Not collective. */
PetscBool EqmHessianAvailable(void)
{
#ifdef EQM_HAVE_SLEPC
  return PETSC_TRUE;
#else
  return PETSC_FALSE;
#endif
}

PetscErrorCode EqmLanczosCheck(MPI_Comm comm, PetscInt num_owned, PetscInt wanted, PetscInt *found)
{
  PetscInt total;

  PetscFunctionBegin;
  *found = 0;
  if (!EqmHessianAvailable())
    EqmFail(comm, EQM_ERR_USAGE,
            "eigenvalues of the Hessian need SLEPc (Debian: slepc-dev); install it and build equimap again");
  PetscCall(MPIU_Allreduce(&num_owned, &total, 1, MPIU_INT, MPI_SUM, comm));
  if (wanted < 1 || wanted > total)
    EqmFail(comm, EQM_ERR_USAGE, "the Hessian has %" PetscInt_FMT " eigenvalues; %" PetscInt_FMT " were asked for",
            total, wanted);
  PetscFunctionReturn(0);
}
