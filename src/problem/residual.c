/* The residuals of ratios. */
#include "problem/residual.h"

static void Log(PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second)
{
  *rho = l;
  *first = 1.;
  *second = 0.;
}

static void Ratio(PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second)
{
  *rho = PetscExpReal(l) - 1.;
  *first = *second = PetscExpReal(l);
}

static void Mixed(PetscReal l, PetscReal *rho, PetscReal *first, PetscReal *second)
{
  if (l > 0.)
    Ratio(l, rho, first, second);
  else
    Log(l, rho, first, second);
}

const EqmResidual EqmResidualLog = {"log", Log, PETSC_TRUE}, EqmResidualMixed = {"mixed", Mixed, PETSC_FALSE},
                  EqmResidualRatio = {"ratio", Ratio, PETSC_FALSE};

PetscErrorCode EqmResidualFind(MPI_Comm comm, const char *name, const EqmResidual **residual)
{
  static const EqmResidual *const all[] = {&EqmResidualLog, &EqmResidualMixed, &EqmResidualRatio};

  PetscFunctionBegin;
  for (size_t k = 0; k < sizeof(all) / sizeof(all[0]); k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(all[k]->name, name, &same));
    *residual = all[k];
    if (same) PetscFunctionReturn(0);
  }
  EqmFail(comm, EQM_ERR_USAGE, "-lm_residual %s: there is no such residual; choose one of log, mixed, ratio", name);
}
