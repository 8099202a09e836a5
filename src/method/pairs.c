#include "method/pairs.h"

struct _p_EqmPairs {
  PetscInt most, count, oldest; /* a ring: pair k, from the oldest, is at (oldest + k) % most */
  Vec *step, *change;
  PetscReal *curvature; /* s.y */
};

/* Allocate `most` pairs of vectors with the layout of `like`. Collective. */
PetscErrorCode EqmPairsCreate(Vec like, PetscInt most, EqmPairs *out)
{
  EqmPairs pairs;

  PetscFunctionBegin;
  PetscCall(PetscNew(&pairs));
  pairs->most = most;
  PetscCall(VecDuplicateVecs(like, most, &pairs->step));
  PetscCall(VecDuplicateVecs(like, most, &pairs->change));
  PetscCall(PetscMalloc1(most, &pairs->curvature));
  *out = pairs;
  PetscFunctionReturn(0);
}

/* Collective. */
PetscErrorCode EqmPairsDestroy(EqmPairs *pairs)
{
  PetscFunctionBegin;
  if (!*pairs) PetscFunctionReturn(0);
  PetscCall(VecDestroyVecs((*pairs)->most, &(*pairs)->step));
  PetscCall(VecDestroyVecs((*pairs)->most, &(*pairs)->change));
  PetscCall(PetscFree((*pairs)->curvature));
  PetscCall(PetscFree(*pairs));
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmPairsForget(EqmPairs pairs)
{
  PetscFunctionBegin;
  pairs->count = pairs->oldest = 0;
  PetscFunctionReturn(0);
}

/* Remember the step scale * step and the change of the gradient over it, unless its curvature is not positive.
   Collective. */
PetscErrorCode EqmPairsAdd(EqmPairs pairs, PetscReal scale, Vec step, Vec old_gradient, Vec new_gradient)
{
  const PetscInt place = (pairs->oldest + pairs->count) % pairs->most;
  PetscReal curvature;

  PetscFunctionBegin;
  PetscCall(VecCopy(step, pairs->step[place]));
  PetscCall(VecScale(pairs->step[place], scale));
  PetscCall(VecWAXPY(pairs->change[place], -1., old_gradient, new_gradient));
  PetscCall(VecDot(pairs->step[place], pairs->change[place], &curvature));
  if (pairs->count == pairs->most) { /* the oldest pair is overwritten even if the new one is rejected */
    pairs->oldest = (pairs->oldest + 1) % pairs->most;
    pairs->count--;
  }
  if (!(curvature > 0.)) PetscFunctionReturn(0);
  pairs->curvature[place] = curvature;
  pairs->count++;
  PetscFunctionReturn(0);
}

/* The two-loop recursion (Nocedal and Wright, Algorithm 7.4): q <- H q. Collective. */
PetscErrorCode EqmPairsDirection(EqmPairs pairs, EqmApplyInverse apply, void *context, Vec q)
{
  PetscReal *alpha, product;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(pairs->most, &alpha));
  for (PetscInt k = pairs->count - 1; k >= 0; k--) {
    const PetscInt place = (pairs->oldest + k) % pairs->most;
    PetscCall(VecDot(pairs->step[place], q, &product));
    alpha[k] = product / pairs->curvature[place];
    PetscCall(VecAXPY(q, -alpha[k], pairs->change[place]));
  }
  PetscCall(apply(context, q));
  for (PetscInt k = 0; k < pairs->count; k++) {
    const PetscInt place = (pairs->oldest + k) % pairs->most;
    PetscCall(VecDot(pairs->change[place], q, &product));
    PetscCall(VecAXPY(q, alpha[k] - product / pairs->curvature[place], pairs->step[place]));
  }
  PetscCall(PetscFree(alpha));
  PetscFunctionReturn(0);
}

/* The pairs from the oldest to the newest; their position in the ring does not matter. */
PetscErrorCode EqmPairsState(EqmPairs pairs, EqmState state, EqmStateVec visit, void *context)
{
  PetscInt count = pairs->count;
  PetscReal *curvature;
  char name[64];

  PetscFunctionBegin;
  PetscCall(EqmStateSameInt(state, "the number of remembered steps", pairs->most));
  PetscCall(EqmStateInt(state, "num_pairs", &count));
  PetscCall(PetscMalloc1(pairs->most, &curvature));
  if (EqmStateIsLoading(state)) {
    pairs->oldest = 0;
    pairs->count = PetscMin(count, pairs->most);
  }
  for (PetscInt k = 0; k < pairs->count; k++) curvature[k] = pairs->curvature[(pairs->oldest + k) % pairs->most];
  PetscCall(EqmStateReals(state, "pairs/curvature", pairs->count, curvature));
  for (PetscInt k = 0; k < pairs->count; k++) {
    const PetscInt place = (pairs->oldest + k) % pairs->most;
    pairs->curvature[place] = curvature[k];
    PetscCall(PetscSNPrintf(name, sizeof(name), "pairs/step%" PetscInt_FMT, k));
    PetscCall(visit(state, context, name, pairs->step[place]));
    PetscCall(PetscSNPrintf(name, sizeof(name), "pairs/change%" PetscInt_FMT, k));
    PetscCall(visit(state, context, name, pairs->change[place]));
  }
  PetscCall(PetscFree(curvature));
  PetscFunctionReturn(0);
}

static PetscErrorCode VisitDofs(EqmState state, void *domain, const char *name, Vec v)
{
  PetscFunctionBegin;
  PetscCall(EqmStateDofs(state, domain, name, v));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmPairsStateDofs(EqmPairs pairs, EqmState state, EqmDomain domain)
{
  PetscFunctionBegin;
  PetscCall(EqmPairsState(pairs, state, VisitDofs, domain));
  PetscFunctionReturn(0);
}
