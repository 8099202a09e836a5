#include "method/pairs.h"
#include "base/vectors.h"

struct _p_EqmPairs {
  PetscInt most, count, oldest; /* a ring: pair k, from the oldest, is at (oldest + k) % most */
  Vec *step, *change;
  PetscReal *product; /* at i most + j the product s_i.y_j, pair i not newer than j, both places in the ring */
  Vec *list;          /* scratch: the pairs' vectors from the oldest to the newest */
  PetscReal *factor, *dot;
};

static inline PetscInt Place(EqmPairs pairs, PetscInt k)
{
  return (pairs->oldest + k) % pairs->most;
}

static inline PetscReal *Product(EqmPairs pairs, PetscInt i, PetscInt j)
{
  return pairs->product + Place(pairs, i) * pairs->most + Place(pairs, j);
}

static Vec *List(EqmPairs pairs, const Vec *of, PetscInt count)
{
  for (PetscInt k = 0; k < count; k++) pairs->list[k] = of[Place(pairs, k)];
  return pairs->list;
}

/* Allocate `most` pairs of vectors with the layout of `like`. Collective. */
PetscErrorCode EqmPairsCreate(Vec like, PetscInt most, EqmPairs *out)
{
  EqmPairs pairs;

  PetscFunctionBegin;
  PetscCall(PetscNew(&pairs));
  pairs->most = most;
  PetscCall(VecDuplicateVecs(like, most, &pairs->step));
  PetscCall(VecDuplicateVecs(like, most, &pairs->change));
  PetscCall(PetscMalloc4(most * most, &pairs->product, most, &pairs->list, most, &pairs->factor, most, &pairs->dot));
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
  PetscCall(PetscFree4((*pairs)->product, (*pairs)->list, (*pairs)->factor, (*pairs)->dot));
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

/* Remember the step scale * step and the change of the gradient over it, unless its curvature is not positive. One
   reduction. Collective. */
PetscErrorCode EqmPairsAdd(EqmPairs pairs, PetscReal scale, Vec step, Vec old_gradient, Vec new_gradient)
{
  PetscFunctionBegin;
  if (pairs->count == pairs->most) { /* the oldest pair is overwritten even if the new one is rejected */
    pairs->oldest = Place(pairs, 1);
    pairs->count--;
  }
  const PetscInt last = pairs->count, place = Place(pairs, last);
  PetscCall(VecCopy(step, pairs->step[place]));
  PetscCall(VecScale(pairs->step[place], scale));
  PetscCall(VecWAXPY(pairs->change[place], -1., old_gradient, new_gradient));
  PetscCall(EqmVecProducts(pairs->change[place], last + 1, List(pairs, pairs->step, last + 1), pairs->dot));
  if (!(pairs->dot[last] > 0.)) PetscFunctionReturn(0);
  for (PetscInt k = 0; k <= last; k++) *Product(pairs, k, last) = pairs->dot[k];
  pairs->count++;
  PetscFunctionReturn(0);
}

/* The two-loop recursion (Nocedal and Wright, Algorithm 7.4): q <- H q. Every product in it is one of q, or of H0 q',
   with the pairs as they are, less what the pairs that have been taken before have changed, which the products of the
   pairs with each other tell: two reductions, however many the pairs. Collective. */
PetscErrorCode EqmPairsDirection(EqmPairs pairs, EqmApplyInverse apply, void *context, Vec q)
{
  const PetscInt count = pairs->count;
  PetscReal *const factor = pairs->factor, *const dot = pairs->dot;

  PetscFunctionBegin;
  if (count == 0) {
    PetscCall(apply(context, q));
    PetscFunctionReturn(0);
  }
  PetscCall(EqmVecProducts(q, count, List(pairs, pairs->step, count), dot));
  for (PetscInt k = count - 1; k >= 0; k--) { /* factor: minus alpha */
    for (PetscInt j = k + 1; j < count; j++) dot[k] += factor[j] * *Product(pairs, k, j);
    factor[k] = -dot[k] / *Product(pairs, k, k);
  }
  PetscCall(EqmVecAddMultiples(q, count, factor, List(pairs, pairs->change, count)));
  PetscCall(apply(context, q));
  PetscCall(EqmVecProducts(q, count, List(pairs, pairs->change, count), dot));
  for (PetscInt k = 0; k < count; k++) { /* factor: alpha minus beta */
    for (PetscInt j = 0; j < k; j++) dot[k] += factor[j] * *Product(pairs, j, k);
    factor[k] = -factor[k] - dot[k] / *Product(pairs, k, k);
  }
  PetscCall(EqmVecAddMultiples(q, count, factor, List(pairs, pairs->step, count)));
  PetscFunctionReturn(0);
}

/* The pairs from the oldest to the newest; their position in the ring does not matter. */
PetscErrorCode EqmPairsState(EqmPairs pairs, EqmState state, EqmStateVec visit, void *context)
{
  PetscInt count = pairs->count;
  char name[64];

  PetscFunctionBegin;
  PetscCall(EqmStateSameInt(state, "the number of remembered steps", pairs->most));
  PetscCall(EqmStateInt(state, "num_pairs", &count));
  if (EqmStateIsLoading(state)) {
    pairs->oldest = 0;
    pairs->count = PetscMin(count, pairs->most);
  }
  for (PetscInt k = 0; k < pairs->count; k++) {
    const PetscInt place = Place(pairs, k);
    for (PetscInt i = 0; i <= k; i++) pairs->dot[i] = *Product(pairs, i, k);
    PetscCall(PetscSNPrintf(name, sizeof(name), "pairs/products%" PetscInt_FMT, k));
    PetscCall(EqmStateReals(state, name, k + 1, pairs->dot));
    for (PetscInt i = 0; i <= k; i++) *Product(pairs, i, k) = pairs->dot[i];
    PetscCall(PetscSNPrintf(name, sizeof(name), "pairs/step%" PetscInt_FMT, k));
    PetscCall(visit(state, context, name, pairs->step[place]));
    PetscCall(PetscSNPrintf(name, sizeof(name), "pairs/change%" PetscInt_FMT, k));
    PetscCall(visit(state, context, name, pairs->change[place]));
  }
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
