#include "method/loopgaps.h"

struct _p_EqmGaps {
  EqmLoop loop;
  PetscReal *least, *gap, *point, *value; /* on rank 0, in the loop's order */
  PetscInt *size;                         /* of blocks that move as one */
};

static const PetscReal share = 1e-2, margin = .9;
/* A gap this close to its bound is at it. */
static const PetscReal slack = 2.;

PetscErrorCode EqmGapsCreate(EqmLoop loop, const PetscReal *x, PetscReal least, EqmGaps *out)
{
  EqmGaps gaps;

  PetscFunctionBegin;
  PetscCall(PetscNew(&gaps));
  gaps->loop = loop;
  PetscCall(PetscMalloc5(loop->count, &gaps->least, loop->count, &gaps->gap, 2 * loop->count, &gaps->point, loop->count,
                         &gaps->value, loop->count, &gaps->size));
  PetscCall(EqmGapsSet(gaps, x));
  for (PetscInt k = 0; k < loop->count; k++) gaps->least[k] = PetscMax(share * gaps->gap[k], least);
  *out = gaps;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGapsDestroy(EqmGaps *gaps)
{
  PetscFunctionBegin;
  if (!*gaps) PetscFunctionReturn(0);
  PetscCall(PetscFree5((*gaps)->least, (*gaps)->gap, (*gaps)->point, (*gaps)->value, (*gaps)->size));
  PetscCall(PetscFree(*gaps));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGapsSet(EqmGaps gaps, const PetscReal *x)
{
  PetscFunctionBegin;
  PetscCall(EqmLoopGaps(gaps->loop, x, gaps->point, gaps->gap));
  PetscFunctionReturn(0);
}

static PetscBool IsAtBound(const struct _p_EqmGaps *gaps, PetscInt k)
{
  return (PetscBool)(gaps->gap[k] <= slack * gaps->least[k]);
}

/* The nearest direction in which no two neighbours at their bound approach: neighbours that would move with the mean of
   theirs, block by block (pool adjacent violators; Ayer, Brunk, Ewing, Reid and Silverman 1955). The walk begins behind
   a gap that is not at its bound. */
static void Pool(EqmGaps gaps)
{
  const PetscInt n = gaps->loop->count;
  PetscReal *const mean = gaps->point; /* of the blocks so far */
  PetscInt first = 0, num = 0, at = 0;

  while (first < n && IsAtBound(gaps, (first + n - 1) % n)) first++;
  for (PetscInt k = 0; k < n; k++) {
    PetscInt begin = k; /* of the last block, in steps from `first` */
    mean[num] = gaps->value[(first + k) % n];
    gaps->size[num++] = 1;
    while (num > 1 && IsAtBound(gaps, (first + begin - 1) % n) && mean[num - 2] > mean[num - 1]) {
      const PetscInt a = gaps->size[num - 2], b = gaps->size[num - 1];
      mean[num - 2] = ((PetscReal)a * mean[num - 2] + (PetscReal)b * mean[num - 1]) / (PetscReal)(a + b);
      gaps->size[--num - 1] = a + b;
      begin = k + 1 - (a + b);
    }
  }
  for (PetscInt block = 0; block < num; block++) {
    for (PetscInt k = 0; k < gaps->size[block]; k++) gaps->value[(first + at++) % n] = mean[block];
  }
}

/* Change a direction on rank 0, where it lies as `value`. */
static PetscErrorCode Change(EqmGaps gaps, void (*change)(EqmGaps), Vec direction)
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArray(direction, &values));
  PetscCall(EqmLoopGather(gaps->loop, values, gaps->value));
  if (gaps->loop->count > 0) change(gaps);
  PetscCall(EqmLoopScatter(gaps->loop, gaps->value, values));
  PetscCall(VecRestoreArray(direction, &values));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGapsProject(EqmGaps gaps, Vec direction)
{
  PetscFunctionBegin;
  PetscCall(Change(gaps, Pool, direction));
  PetscFunctionReturn(0);
}

/* Of the changes of gaps those that would close one become what closes it nearly; all gaps that are not at their bounds
   give to that in proportion. Then angles again, with the mean of those before. */
static void Clip(EqmGaps gaps)
{
  const PetscInt n = gaps->loop->count;
  PetscReal *const change = gaps->point, *const angle = gaps->value;
  PetscReal excess = 0., total = 0., mean = 0., next = 0., new_mean = 0.;

  for (PetscInt k = 0; k < n; k++) {
    change[k] = PetscMax(angle[(k + 1) % n] - angle[k], -margin * PetscMax(0., gaps->gap[k] - gaps->least[k]));
    excess += change[k];
    total += IsAtBound(gaps, k) ? 0. : gaps->gap[k];
    mean += angle[k] / (PetscReal)n;
  }
  for (PetscInt k = 0; k < n; k++) {
    angle[k] = next;
    new_mean += next / (PetscReal)n;
    next += change[k] - (IsAtBound(gaps, k) ? 0. : excess * gaps->gap[k] / total);
  }
  for (PetscInt k = 0; k < n; k++) angle[k] += mean - new_mean;
}

PetscErrorCode EqmGapsClip(EqmGaps gaps, Vec direction)
{
  PetscFunctionBegin;
  PetscCall(Change(gaps, Clip, direction));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmGapsLongestStep(EqmGaps gaps, Vec direction, PetscReal *t)
{
  const PetscInt n = gaps->loop->count;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(direction, &values));
  PetscCall(EqmLoopGather(gaps->loop, values, gaps->value));
  PetscCall(VecRestoreArrayRead(direction, &values));
  *t = 1.;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal closing = gaps->value[k] - gaps->value[(k + 1) % n];
    if (closing > 0.) *t = PetscMin(*t, margin * PetscMax(0., gaps->gap[k] - gaps->least[k]) / closing);
  }
  PetscCallMPI(MPI_Bcast(t, 1, MPIU_REAL, 0, gaps->loop->comm));
  PetscFunctionReturn(0);
}
