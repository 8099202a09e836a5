/* Strong Wolfe conditions by bracketing and cubic interpolation (Nocedal and Wright, Algorithms 3.5 and 3.6). */
#include "method/wolfe.h"

static const PetscReal decrease = 1e-4; /* c1 */
enum { MOST_TRIALS = 20 };

typedef struct {
  PetscReal t, value, slope;
} Sample;

/* The minimum of the cubic through two samples, clamped to a tenth of the interval's length from its ends. */
static PetscReal CubicMinimum(const Sample *a, const Sample *b)
{
  const PetscReal low = PetscMin(a->t, b->t), width = PetscAbsReal(a->t - b->t);
  const PetscReal d = a->slope + b->slope - 3. * (a->value - b->value) / (a->t - b->t);
  const PetscReal squared = d * d - a->slope * b->slope;
  PetscReal t = low + .5 * width;

  if (squared >= 0.) {
    const PetscReal root = (b->t > a->t ? 1. : -1.) * PetscSqrtReal(squared);
    t = b->t - (b->t - a->t) * (b->slope + root - d) / (b->slope - a->slope + 2. * root);
  }
  if (PetscIsInfOrNanReal(t)) t = low + .5 * width;
  return PetscMin(low + .9 * width, PetscMax(low + .1 * width, t));
}

/* EqmWolfeSearch - a step length t with value(t) <= value + c1 t slope and |slope(t)| <= c2 |slope|.

   Collective. value, slope - at t = 0, the slope negative; flatness - c2; t - 1 is tried first; the last trial is that
   of the answer; if the second condition is not met within the trials, the best length that meets the first, 0 if there
   is none. */
PetscErrorCode EqmWolfeSearch(EqmTryStep try_step, void *context, PetscReal value, PetscReal slope, PetscReal flatness,
                              PetscReal *t, PetscReal *new_value)
{
  Sample low = {0., value, slope}, high = low, now = {1., 0., 0.};
  PetscBool bracketed = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    PetscCall(try_step(context, now.t, &now.value, &now.slope));
    const PetscBool finite = (PetscBool) !(PetscIsInfOrNanReal(now.value) || PetscIsInfOrNanReal(now.slope));
    if (!finite || now.value > value + decrease * now.t * slope || (low.t > 0. && now.value >= low.value)) {
      high = now;
      bracketed = PETSC_TRUE;
    } else {
      *t = now.t;
      *new_value = now.value;
      if (PetscAbsReal(now.slope) <= -flatness * slope) PetscFunctionReturn(0);
      if (bracketed ? now.slope * (high.t - low.t) >= 0. : now.slope >= 0.) {
        high = low;
        bracketed = PETSC_TRUE;
      }
      low = now;
    }
    if (!bracketed)
      now.t *= 2.5;
    else
      now.t = finite ? CubicMinimum(&low, &high) : .1 * now.t + .9 * low.t;
  }
  *t = low.t;
  *new_value = low.value;
  if (low.t > 0.) PetscCall(try_step(context, low.t, &low.value, &low.slope));
  PetscFunctionReturn(0);
}
