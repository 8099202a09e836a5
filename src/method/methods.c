/* The methods that the library comes with. */
#include "method/method.h"

static const struct {
  const char *name;
  PetscErrorCode (*create)(EqmMethod);
} rows[] = {
    {"lm", EqmMethodCreateLm},
    {"fixed-point", EqmMethodCreateFixedPoint},
    {"ncg", EqmMethodCreateNcg},
    {"lbfgs", EqmMethodCreateLbfgs},
    {"rgd", EqmMethodCreateRgd},
    {"newton", EqmMethodCreateNewton},
    {"cascade", EqmMethodCreateCascade},
    {"riemann", EqmMethodCreateRiemann},
    {"covering", EqmMethodCreateCovering},
    {"covering-explicit", EqmMethodCreateCoveringExplicit},
    {"covering-implicit", EqmMethodCreateCoveringImplicit},
    {"qiem", EqmMethodCreateQiem},
    {"euler-explicit", EqmMethodCreateEulerExplicit},
    {"euler-implicit", EqmMethodCreateEulerImplicit},
};
enum { NUM_ROWS = sizeof(rows) / sizeof(rows[0]) };

PetscErrorCode EqmMethodRegisterAll(void)
{
  PetscFunctionBegin;
  for (size_t k = 0; k < NUM_ROWS; k++) {
    PetscBool there;
    PetscCall(EqmMethodIsRegistered(rows[k].name, &there));
    if (!there) PetscCall(EqmMethodRegister(rows[k].name, rows[k].create));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMethodIsForeign(const char *name, PetscBool *foreign)
{
  PetscFunctionBegin;
  PetscCall(EqmMethodIsRegistered(name, foreign));
  for (size_t k = 0; k < NUM_ROWS && *foreign; k++) {
    PetscBool same;
    PetscCall(PetscStrcmp(rows[k].name, name, &same));
    if (same) *foreign = PETSC_FALSE;
  }
  PetscFunctionReturn(0);
}
