/* Solves with the multifrontal factor: up the tree with L, down with its transpose. Right-hand sides lie row by row. */
#include "linalg/frontal_private.h"
#include <stdlib.h>

/* Columns are taken so many at a time. */
typedef struct {
  EqmFrontal f;
  PetscInt count;
} Sweep;

/* The rows of a front from the right-hand sides: its own ones, or all. */
static void Gather(const Sweep *s, PetscInt k, PetscBool all, PetscScalar *x)
{
  const EqmFrontal f = s->f;
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k), count = s->count;

  for (PetscInt i = 0; i < columns; i++) {
    const PetscScalar *const from = f->columns + (size_t)(f->column[k] + i) * (size_t)count;
    for (PetscInt c = 0; c < count; c++) x[(size_t)c * (size_t)rows + i] = from[c];
  }
  for (PetscInt i = columns; i < rows; i++) {
    const PetscScalar *const from = f->columns + (size_t)f->row[f->row_start[k] + i] * (size_t)count;
    for (PetscInt c = 0; c < count; c++) x[(size_t)c * (size_t)rows + i] = all ? from[c] : 0.;
  }
}

static void PutOwn(const Sweep *s, PetscInt k, const PetscScalar *x)
{
  const EqmFrontal f = s->f;
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k), count = s->count;

  for (PetscInt i = 0; i < columns; i++) {
    PetscScalar *const to = f->columns + (size_t)(f->column[k] + i) * (size_t)count;
    for (PetscInt c = 0; c < count; c++) to[c] = x[(size_t)c * (size_t)rows + i];
  }
}

/* Work space for the rows of a front. */
static PetscScalar *Allocate(const Sweep *s, PetscInt k)
{
  PetscScalar *const x = malloc((size_t)s->f->most_rows[k] * (size_t)s->count * sizeof(PetscScalar));

  if (!x) {
#pragma omp atomic write
    s->f->no_memory = 1;
  }
  return x;
}

static PetscScalar *Passed(const Sweep *s, PetscInt k)
{
  return s->f->passed + (size_t)s->f->passed_start[k] * (size_t)s->count;
}

/* Substitution with a front's columns. */
static void Forward(const Sweep *s, PetscInt k, PetscScalar *x)
{
  const EqmFrontal f = s->f;
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k);

  if (f->is_single)
    EqmDenseForwardSingle((const float *)f->value + f->value_start[k], rows, columns, s->count, x);
  else
    EqmDenseForward((const PetscScalar *)f->value + f->value_start[k], rows, columns, s->count, x);
}

static void Backward(const Sweep *s, PetscInt k, PetscScalar *x)
{
  const EqmFrontal f = s->f;
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k);

  if (f->is_single)
    EqmDenseBackwardSingle((const float *)f->value + f->value_start[k], rows, columns, s->count, x);
  else
    EqmDenseBackward((const PetscScalar *)f->value + f->value_start[k], rows, columns, s->count, x);
}

static void ForwardBranch(const Sweep *s, PetscInt end)
{
  const EqmFrontal f = s->f;
  const PetscInt count = s->count;
  PetscScalar *const x = Allocate(s, end), *const passed = Passed(s, end);

  for (PetscInt i = 0; i < EqmFrontRest(f, end) * count; i++) passed[i] = 0.;
  for (PetscInt k = f->first_below[end]; x && k <= end; k++) {
    const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k);
    Gather(s, k, PETSC_FALSE, x);
    Forward(s, k, x);
    PutOwn(s, k, x);
    for (PetscInt i = columns; i < rows; i++) {
      const PetscInt row = f->row[f->row_start[k] + i];
      PetscScalar *const to = row < f->column[end + 1] ? f->columns + (size_t)row * (size_t)count
                                                       : passed + f->at_end[f->row_start[k] + i] * count;
      for (PetscInt c = 0; c < count; c++) to[c] += x[(size_t)c * (size_t)rows + i];
    }
  }
  free(x);
}

/* L y = b on a front and all below it. */
static void ForwardTree(const Sweep *s, PetscInt k)
{
  const EqmFrontal f = s->f;
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k), count = s->count;

  if (f->is_branch[k]) {
    ForwardBranch(s, k);
    return;
  }
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) {
    const PetscInt child = f->child[q];
#pragma omp task default(none) firstprivate(s, child)
    ForwardTree(s, child);
  }
#pragma omp taskwait
  PetscScalar *const x = Allocate(s, k), *const passed = Passed(s, k);
  if (!x) return;
  Gather(s, k, PETSC_FALSE, x);
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) {
    const PetscInt child = f->child[q], *const place = f->at_parent + f->row_start[child] + EqmFrontColumns(f, child);
    const PetscScalar *const from = Passed(s, child);
    for (PetscInt i = 0; i < EqmFrontRest(f, child); i++) {
      for (PetscInt c = 0; c < count; c++) x[(size_t)c * (size_t)rows + place[i]] += from[i * count + c];
    }
  }
  Forward(s, k, x);
  PutOwn(s, k, x);
  for (PetscInt i = columns; i < rows; i++) {
    for (PetscInt c = 0; c < count; c++) passed[(i - columns) * count + c] = x[(size_t)c * (size_t)rows + i];
  }
  free(x);
}

/* L^T x = y on a front, given x of the rows above it, and on all below it. */
static void BackwardTree(const Sweep *s, PetscInt k)
{
  const EqmFrontal f = s->f;
  const PetscInt first = f->is_branch[k] ? f->first_below[k] : k;
  PetscScalar *const x = Allocate(s, k);

  for (PetscInt j = k; x && j >= first; j--) {
    Gather(s, j, PETSC_TRUE, x);
    Backward(s, j, x);
    PutOwn(s, j, x);
  }
  free(x);
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1] && !f->is_branch[k]; q++) {
    const PetscInt child = f->child[q];
#pragma omp task default(none) firstprivate(s, child)
    BackwardTree(s, child);
  }
}

/* At most EQM_MOST_COLUMNS columns. */
static void SolveColumns(EqmFrontal f, EqmSolveHalf half, PetscInt count, const PetscScalar *b, PetscScalar *x)
{
  const PetscInt n = f->num_unknowns, *const root = f->child + f->child_start[f->num_fronts],
                 num_roots = f->child_start[f->num_fronts + 1] - f->child_start[f->num_fronts];
  const Sweep sweep = {f, count}, *const s = &sweep;

#pragma omp parallel if (f->flops > EQM_FRONTAL_LEAST_FLOPS)
  {
#pragma omp for schedule(static)
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt c = 0; c < count; c++)
        f->columns[(size_t)f->position[i] * (size_t)count + c] = b[(size_t)c * (size_t)n + i];
    }
#pragma omp single
    for (PetscInt k = 0; k < num_roots && half & EQM_SOLVE_FORWARD; k++) {
#pragma omp task default(none) firstprivate(s, k) shared(root)
      ForwardTree(s, root[k]);
    }
#pragma omp single
    for (PetscInt k = 0; k < num_roots && half & EQM_SOLVE_BACKWARD; k++) {
#pragma omp task default(none) firstprivate(s, k) shared(root)
      BackwardTree(s, root[k]);
    }
#pragma omp for schedule(static)
    for (PetscInt i = 0; i < n; i++) {
      for (PetscInt c = 0; c < count; c++)
        x[(size_t)c * (size_t)n + i] = f->columns[(size_t)f->position[i] * (size_t)count + c];
    }
  }
}

PetscErrorCode EqmFrontalSolve(EqmFrontal f, EqmSolveHalf half, PetscInt num_rhs, const PetscScalar *b, PetscScalar *x)
{
  const size_t n = (size_t)f->num_unknowns, passed = (size_t)f->passed_start[f->num_fronts];

  PetscFunctionBegin;
  if (!f->columns) PetscCall(PetscMalloc2(EQM_MOST_COLUMNS * n, &f->columns, EQM_MOST_COLUMNS * passed, &f->passed));
  f->no_memory = 0;
  for (PetscInt c = 0; c < num_rhs; c += EQM_MOST_COLUMNS)
    SolveColumns(f, half, PetscMin(EQM_MOST_COLUMNS, num_rhs - c), b + (size_t)c * n, x + (size_t)c * n);
  PetscFunctionReturn(0);
}
