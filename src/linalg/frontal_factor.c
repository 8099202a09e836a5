/* The numerical factorisation, front by front: assemble its columns, eliminate them, update the rest. */
#include "linalg/frontal_private.h"
#include <stdlib.h>
#include <string.h>

/* Work on one large front is divided in pieces of so many columns or rows. */
enum { BLOCK = 64, ROWS_OF_PIECE = 128 };

static void Note(int *flag)
{
#pragma omp atomic write
  *flag = 1;
}

static PetscBool HasFailed(EqmFrontal f)
{
  int not_definite, no_memory;

#pragma omp atomic read
  not_definite = f->not_definite;
#pragma omp atomic read
  no_memory = f->no_memory;
  return (PetscBool)(not_definite || no_memory);
}

/* Allocate n numbers of `size` bytes; records a failure. */
static void *Allocate(EqmFrontal f, size_t n, size_t size)
{
  void *const room = malloc(PetscMax(n, 1) * size);

  if (!room) Note(&f->no_memory);
  return room;
}

/* Add the columns begin .. end - 1 of a child's update: to the front's own columns (`update` NULL) or to its update. */
static void TakeColumns(EqmFrontal f, PetscInt k, PetscInt child, PetscInt begin, PetscInt end, PetscScalar *update)
{
  const PetscInt rest = EqmFrontRest(f, child), rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k);
  const PetscInt *const place = f->at_parent + f->row_start[child] + EqmFrontColumns(f, child);

  for (PetscInt j = begin; j < end; j++) {
    const PetscScalar *const from = f->update[child] + (size_t)j * (size_t)rest;
    if (update && place[j] >= columns) {
      PetscScalar *const to = update + (size_t)(place[j] - columns) * (size_t)(rows - columns);
      for (PetscInt i = j; i < rest; i++) to[place[i] - columns] += from[i];
    } else if (!update && place[j] < columns) {
      PetscScalar *const to = f->panel[k] + (size_t)place[j] * (size_t)rows;
      for (PetscInt i = j; i < rest; i++) to[place[i]] += from[i];
    }
  }
}

static void TakeChildren(EqmFrontal f, PetscInt k, PetscBool divide, PetscScalar *update)
{
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) {
    const PetscInt child = f->child[q], rest = EqmFrontRest(f, child), block = BLOCK;
    if (rest == 0) continue; /* clang 14's runtime does not come back from a taskloop of nothing */
    if (!divide) {
      TakeColumns(f, k, child, 0, rest, update);
      continue;
    }
#pragma omp taskloop grainsize(1)
    for (PetscInt j = 0; j < rest; j += block) TakeColumns(f, k, child, j, PetscMin(j + block, rest), update);
  }
}

/* The front's own columns, assembled. */
static void Assemble(EqmFrontal f, PetscInt k, PetscBool divide, const PetscScalar *matrix)
{
  const size_t numbers = (size_t)EqmFrontRows(f, k) * (size_t)EqmFrontColumns(f, k);

  memset(f->panel[k], 0, numbers * sizeof(PetscScalar));
  for (PetscInt q = f->entry_start[k]; q < f->entry_start[k + 1]; q++)
    f->panel[k][f->entry_target[q]] = matrix[f->entry_source[q]];
  TakeChildren(f, k, divide, NULL);
}

/* Their columns of L. */
static void Eliminate(EqmFrontal f, PetscInt k, PetscBool divide)
{
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k), block = BLOCK;
  PetscScalar *const own = f->panel[k];

  for (PetscInt begin = 0; begin < columns; begin += block) {
    const PetscInt end = PetscMin(begin + block, columns), piece = ROWS_OF_PIECE;
    if (!EqmDenseFactorBlock(own, rows, begin, end)) {
      Note(&f->not_definite);
      return;
    }
    if (end == rows) return;
    if (!divide) {
      EqmDenseFactorRows(own, rows, begin, end, end, rows);
      continue;
    }
#pragma omp taskloop grainsize(1)
    for (PetscInt i = end; i < rows; i += piece)
      EqmDenseFactorRows(own, rows, begin, end, i, PetscMin(i + piece, rows));
  }
}

/* What they leave for the rest. */
static void Update(EqmFrontal f, PetscInt k, PetscBool divide, PetscScalar *update)
{
  const PetscInt rows = EqmFrontRows(f, k), columns = EqmFrontColumns(f, k), rest = rows - columns, block = BLOCK;
  const PetscScalar *const below = f->panel[k] + columns;

  if (!divide) {
    EqmDenseUpdate(below, rows, rest, columns, 0, rest, update);
  } else {
#pragma omp taskloop grainsize(1)
    for (PetscInt j = 0; j < rest; j += block)
      EqmDenseUpdate(below, rows, rest, columns, j, PetscMin(j + block, rest), update);
  }
  TakeChildren(f, k, divide, update);
}

/* What is wanted of the factor in double precision. */
static void KeepBlock(EqmFrontal f, PetscInt k)
{
  const PetscInt rows = EqmFrontRows(f, k), *const row = f->row + f->row_start[k];

  for (PetscInt j = 0; j < EqmFrontColumns(f, k); j++) {
    const PetscScalar *const from = f->panel[k] + (size_t)j * (size_t)rows;
    const PetscInt column = f->kept_at[f->column[k] + j];
    for (PetscInt i = j; i < rows && column >= 0; i++) { /* fronts hold zeros of other unknowns, too */
      const PetscInt at = f->kept_at[row[i]];
      if (at >= 0) f->kept_block[(size_t)column * (size_t)f->num_kept + (size_t)at] = from[i];
    }
  }
}

/* One front. `work`: of single precision, room for its columns; `update` gets its update matrix. */
static void FactorFront(EqmFrontal f, PetscInt k, PetscBool divide, const PetscScalar *matrix, PetscScalar *work,
                        PetscScalar *update)
{
  f->panel[k] = f->is_single ? work : (PetscScalar *)f->value + f->value_start[k];
  Assemble(f, k, divide, matrix);
  Eliminate(f, k, divide);
  if (EqmFrontRest(f, k) > 0) Update(f, k, divide, update);
  if (f->kept_at) KeepBlock(f, k);
  if (f->is_single &&
      !EqmDenseNarrow(f->panel[k], EqmFrontRows(f, k), EqmFrontColumns(f, k), (float *)f->value + f->value_start[k]))
    Note(&f->not_definite);
  f->update[k] = update;
}

/* All of a branch: updates lie on a stack, that of the last front has a place of its own. */
static void FactorBranch(EqmFrontal f, PetscInt end, const PetscScalar *matrix)
{
  const size_t last = (size_t)EqmFrontRest(f, end);
  PetscScalar *const stack = Allocate(f, f->stack[end], sizeof(PetscScalar)),
                     *const update = Allocate(f, last * last, sizeof(PetscScalar)),
                     *const work = Allocate(f, f->is_single ? f->most_panel[end] : 0, sizeof(PetscScalar));
  size_t top = 0;

  for (PetscInt k = f->first_below[end]; stack && update && work && k <= end && !HasFailed(f); k++) {
    const size_t rest = (size_t)EqmFrontRest(f, k);
    size_t bottom = top;
    FactorFront(f, k, PETSC_FALSE, matrix, work, k < end ? stack + top : update);
    for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) {
      const size_t of_child = (size_t)EqmFrontRest(f, f->child[q]);
      bottom -= of_child * of_child;
    }
    if (k == end) break;
    if (bottom < top) memmove(stack + bottom, stack + top, rest * rest * sizeof(PetscScalar));
    f->update[k] = stack + bottom;
    top = bottom + rest * rest;
  }
  f->update[end] = update;
  free(work);
  free(stack);
}

/* A front and all below it. */
static void FactorTree(EqmFrontal f, PetscInt k, const PetscScalar *matrix)
{
  if (f->is_branch[k]) {
    FactorBranch(f, k, matrix);
    return;
  }
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) {
    const PetscInt child = f->child[q];
#pragma omp task default(none) firstprivate(f, child, matrix)
    FactorTree(f, child, matrix);
  }
#pragma omp taskwait
  const size_t rest = (size_t)EqmFrontRest(f, k);
  PetscScalar *const update = Allocate(f, rest * rest, sizeof(PetscScalar)), *const work = Allocate(
                                                                                 f, f->is_single ? f->most_panel[k] : 0,
                                                                                 sizeof(PetscScalar));
  if (!HasFailed(f)) FactorFront(f, k, PETSC_TRUE, matrix, work, update);
  f->update[k] = update;
  free(work);
  for (PetscInt q = f->child_start[k]; q < f->child_start[k + 1]; q++) free(f->update[f->child[q]]);
}

PetscErrorCode EqmFrontalFactor(EqmFrontal f, const PetscScalar *value, PetscBool *success)
{
  const PetscInt *const root = f->child + f->child_start[f->num_fronts],
                        num_roots = f->child_start[f->num_fronts + 1] - f->child_start[f->num_fronts];

  PetscFunctionBegin;
  *success = PETSC_FALSE;
  f->not_definite = f->no_memory = 0;
  if (!f->value) f->value = Allocate(f, f->symbolic->xsize, f->is_single ? sizeof(float) : sizeof(PetscScalar));
  if (f->no_memory) PetscFunctionReturn(0);
  if (f->kept_at) PetscCall(PetscArrayzero(f->kept_block, (size_t)f->num_kept * (size_t)f->num_kept));
#pragma omp parallel if (f->flops > EQM_FRONTAL_LEAST_FLOPS)
#pragma omp single
  {
    for (PetscInt k = 0; k < num_roots; k++) {
#pragma omp task default(none) firstprivate(f, k, value) shared(root)
      FactorTree(f, root[k], value);
    }
  }
  for (PetscInt k = 0; k < num_roots; k++) free(f->update[root[k]]);
  *success = (PetscBool)!HasFailed(f);
  PetscFunctionReturn(0);
}
