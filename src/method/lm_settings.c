/* Settings of lm: quasi-Newton steps per factor, the residual. */
#include "method/lm.h"

PetscErrorCode EqmLmSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  EqmLm *const lm = method->data;
  char name[32];
  PetscBool given, is_auto;

  PetscFunctionBegin;
  PetscCall(PetscOptionsBoundedInt("-lm_inner",
                                   "lm: at most so many quasi-Newton steps on each factor; with 0 a map takes more "
                                   "factorisations, and hardly magnifies the rounding of the input",
                                   "EqmSolverSetFromOptions", lm->most_inner, &lm->most_inner, NULL, 0));
  PetscCall(PetscOptionsString("-lm_residual",
                               "lm: what is squared of each ratio r: log (of r, less its mean), mixed (r - 1 where r > "
                               "1, else log r), ratio (r - 1), or auto: mixed beside the angle energy and with "
                               "-linear_solver hierarchy, else log",
                               "EqmSolverSetFromOptions", "auto", name, sizeof(name), &given));
  if (!given) PetscFunctionReturn(0);
  PetscCall(PetscStrcmp(name, "auto", &is_auto));
  lm->wanted = NULL;
  if (!is_auto) PetscCall(EqmResidualFind(method->comm, name, &lm->wanted));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmSetInnerSteps(EqmMethod method, PetscInt steps)
{
  PetscFunctionBegin;
  ((EqmLm *)method->data)->most_inner = steps;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmSetResidual(EqmMethod method, const EqmResidual *residual)
{
  PetscFunctionBegin;
  ((EqmLm *)method->data)->wanted = residual;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmIsByLogarithms(EqmMethod method, PetscBool *is)
{
  const EqmLm *const lm = method->data;

  PetscFunctionBegin;
  *is = (PetscBool)(!lm->wanted && lm->residual == &EqmResidualLog);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmLmChooseResidual(EqmMethod method)
{
  EqmLm *const lm = method->data;
  PetscBool has_angle = PETSC_FALSE;

  PetscFunctionBegin;
  for (EqmTerm term = method->problem->terms; term && !has_angle; term = term->next)
    PetscCall(PetscStrcmp(term->name, "angle", &has_angle));
  lm->residual = lm->wanted ? lm->wanted : has_angle || lm->by_cycles ? &EqmResidualMixed : &EqmResidualLog;
  PetscFunctionReturn(0);
}
