/* The table of methods. */
#include "method/method.h"

static const EqmMethod *const methods[] = {&EqmMethodFixedPoint, &EqmMethodNcg, &EqmMethodLbfgs, &EqmMethodRgd,
                                           &EqmMethodLm};
enum { NUM_METHODS = sizeof(methods) / sizeof(methods[0]) };

/* The method of a name; "auto" is the best known for the target. Errors: EQM_ERR_USAGE. Collective. */
PetscErrorCode EqmMethodFind(const char *name, const EqmMethod **method)
{
  char names[EQM_MESSAGE_MAX];
  PetscBool same;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(name, "auto", &same));
  if (same) {
    *method = &EqmMethodLm;
    PetscFunctionReturn(0);
  }
  for (int k = 0; k < NUM_METHODS; k++) {
    PetscCall(PetscStrcmp(name, methods[k]->name, &same));
    if (!same) continue;
    *method = methods[k];
    PetscFunctionReturn(0);
  }
  PetscCall(EqmMethodNames(names, sizeof(names)));
  EqmFail(PETSC_COMM_WORLD, EQM_ERR_USAGE, "-method %s: there is no such method; choose one of %s", name, names);
}

/* The names of all methods, separated by commas. Not collective. */
PetscErrorCode EqmMethodNames(char *text, size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, "auto", length));
  for (int k = 0; k < NUM_METHODS; k++) {
    PetscCall(PetscStrlcat(text, ", ", length));
    PetscCall(PetscStrlcat(text, methods[k]->name, length));
  }
  PetscFunctionReturn(0);
}
