/* Brent's bounded minimisation (Algorithms for Minimization without Derivatives, 1973, chapter 5): parabolas, and
   golden sections where these do not help. */
#include "method/brent.h"

enum { MOST_TRIALS = 100 };
static const PetscReal tolerance = 1e-4;

typedef struct {
  PetscReal t, value;
} Sample;

typedef struct {
  PetscReal low, high;         /* the minimum is between */
  Sample best, second, third;  /* of all samples, but for those that were third before */
  PetscReal step, step_before; /* the last two, before they were kept inside the bracket */
} Bracket;

/* Where the parabola through the three samples has its extremum, as p / q from the best of them; q is not negative. */
static void Parabola(const Bracket *b, PetscReal *p, PetscReal *q)
{
  const PetscReal to_second = b->best.t - b->second.t, to_third = b->best.t - b->third.t;
  const PetscReal s = to_second * (b->best.value - b->third.value), t = to_third * (b->best.value - b->second.value);
  const PetscReal numerator = to_third * t - to_second * s, denominator = 2. * (t - s);

  *p = denominator > 0. ? -numerator : numerator;
  *q = PetscAbsReal(denominator);
}

/* The next sample's place: no closer than `close` to the best and to the ends, and by parabolas only while their steps
   halve every other time. */
static PetscReal NextPlace(Bracket *b, PetscReal close)
{
  const PetscReal golden = .5 * (3. - PetscSqrtReal(5.)), x = b->best.t, bound = b->step_before;
  const PetscBool left = (PetscBool)(x < .5 * (b->low + b->high));
  PetscReal p = 0., q = 0.;

  if (PetscAbsReal(bound) > close) {
    Parabola(b, &p, &q);
    b->step_before = b->step;
  }
  if (PetscAbsReal(p) < PetscAbsReal(.5 * q * bound) && p > q * (b->low - x) && p < q * (b->high - x)) {
    const PetscReal place = x + p / q;
    b->step = p / q;
    if (place - b->low < 2. * close || b->high - place < 2. * close) b->step = left ? close : -close;
  } else {
    b->step_before = left ? b->high - x : b->low - x;
    b->step = golden * b->step_before;
  }
  if (PetscAbsReal(b->step) >= close) return x + b->step;
  return b->step > 0. ? x + close : x - close;
}

static void Narrow(Bracket *b, Sample now)
{
  const PetscBool better = (PetscBool)(now.value <= b->best.value), left = (PetscBool)(now.t < b->best.t);
  const PetscReal end = better ? b->best.t : now.t;

  if (left == better)
    b->high = end;
  else
    b->low = end;
  if (better || now.value <= b->second.value || b->second.t == b->best.t) {
    b->third = b->second;
    b->second = better ? b->best : now;
  } else if (now.value <= b->third.value || b->third.t == b->best.t || b->third.t == b->second.t) {
    b->third = now;
  }
  if (better) b->best = now;
}

/* EqmBrentSearch - a minimum of a function on (0, 1), to four digits, and its value.

   Collective. */
PetscErrorCode EqmBrentSearch(EqmFunction function, void *context, PetscReal *t, PetscReal *value)
{
  Bracket b = {.low = 0., .high = 1.};
  Sample now = {.t = .5 * (3. - PetscSqrtReal(5.))};

  PetscFunctionBegin;
  PetscCall(function(context, now.t, &now.value));
  b.best = b.second = b.third = now;
  for (PetscInt trial = 0; trial < MOST_TRIALS; trial++) {
    const PetscReal close = PETSC_SQRT_MACHINE_EPSILON * PetscAbsReal(b.best.t) + tolerance / 3.;
    if (PetscAbsReal(b.best.t - .5 * (b.low + b.high)) <= 2. * close - .5 * (b.high - b.low)) break;
    now.t = NextPlace(&b, close);
    PetscCall(function(context, now.t, &now.value));
    Narrow(&b, now);
  }
  *t = b.best.t;
  *value = b.best.value;
  PetscFunctionReturn(0);
}
