/* The search for a minimum from values alone. */
#include "support/testing.h"
#include "method/brent.h"

typedef struct {
  PetscInt which, evaluations;
} Case;

enum { PARABOLA, KINK, QUARTIC, RISING, FALLING };

static PetscErrorCode Function(void *context, PetscReal t, PetscReal *value)
{
  Case *const c = context;
  const PetscReal values[] = {PetscSqr(t - .3), PetscAbsReal(t - .7), PetscSqr(PetscSqr(t - .2)) + t, PetscExpReal(t),
                              -t};

  PetscFunctionBegin;
  CHECK(t > 0. && t < 1., "evaluated at %g", (double)t);
  *value = values[c->which];
  c->evaluations++;
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  const PetscReal minimum[] = {.3, .7, 0., 0., 1.};

  PetscFunctionBeginUser;
  PetscCall(EqmInitialize(&argc, &argv));
  for (PetscInt k = PARABOLA; k <= FALLING; k++) {
    Case c = {.which = k};
    PetscReal t, value, again;
    PetscCall(EqmBrentSearch(Function, &c, &t, &value));
    CHECK_CLOSE(t, minimum[k], 1e-3, 1.);
    CHECK(c.evaluations < 60, "%d evaluations for function %d", (int)c.evaluations, (int)k);
    PetscCall(Function(&c, t, &again));
    CHECK(value == again, "function %d: %g, not %g", (int)k, (double)again, (double)value);
  }
  PetscCall(EqmFinalize());
  PetscFunctionReturn(0);
}
