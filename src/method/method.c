/* The registry of methods, and what all of them have in common. */
#include "method/method.h"

static PetscFunctionList methods = NULL;

static PetscErrorCode DestroyList(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&methods));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodRegister(const char *name, PetscErrorCode (*create)(EqmMethod))
{
  PetscFunctionBegin;
  if (!methods) PetscCall(PetscRegisterFinalize(DestroyList));
  PetscCall(PetscFunctionListAdd(&methods, name, create));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodIsRegistered(const char *name, PetscBool *is)
{
  PetscErrorCode (*create)(EqmMethod);

  PetscFunctionBegin;
  PetscCall(PetscFunctionListFind(methods, name, &create));
  *is = (PetscBool)(create != NULL);
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodCreate(MPI_Comm comm, const char *name, EqmMethod *out)
{
  PetscErrorCode (*create)(EqmMethod);
  EqmMethod method;

  PetscFunctionBegin;
  PetscCall(PetscFunctionListFind(methods, name, &create));
  if (!create) EqmFail(comm, EQM_ERR_USAGE, "there is no method '%s'", name);
  PetscCall(PetscNew(&method));
  method->comm = comm;
  PetscCall(PetscStrncpy(method->name, name, sizeof(method->name)));
  PetscCall(create(method));
  *out = method;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodReset(EqmMethod method)
{
  PetscFunctionBegin;
  if (method->is_set_up && method->ops.reset) PetscCall(method->ops.reset(method));
  method->is_set_up = PETSC_FALSE;
  method->problem = NULL;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodDestroy(EqmMethod *method)
{
  PetscFunctionBegin;
  if (!*method) PetscFunctionReturn(0);
  PetscCall(EqmMethodReset(*method));
  if ((*method)->ops.destroy)
    PetscCall((*method)->ops.destroy(*method));
  else
    PetscCall(PetscFree((*method)->data));
  PetscCall(PetscFree(*method));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodSetFromOptions(EqmMethod method, PetscOptionItems *PetscOptionsObject)
{
  PetscFunctionBegin;
  if (method->ops.set_from_options) PetscCall(method->ops.set_from_options(method, PetscOptionsObject));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodSetUp(EqmMethod method, EqmProblem problem, EqmIterate iterate)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodReset(method));
  method->problem = problem;
  method->iterate = iterate;
  method->message[0] = '\0';
  method->is_set_up = PETSC_TRUE;
  PetscCall(method->ops.set_up(method, iterate));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodStep(EqmMethod method, EqmIterate iterate, EqmStep *outcome)
{
  PetscFunctionBegin;
  method->iterate = iterate;
  PetscCall(method->ops.step(method, iterate, outcome));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodVisitState(EqmMethod method, EqmIterate iterate, EqmState state)
{
  PetscFunctionBegin;
  if (method->ops.state) PetscCall(method->ops.state(method, iterate, state));
  PetscFunctionReturn(0);
}
