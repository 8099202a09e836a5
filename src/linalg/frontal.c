/* Symbolic work of the multifrontal factor: supernodes by CHOLMOD, then which front takes what from where, and which
   branches of the tree one thread does alone. */
#include "linalg/frontal_private.h"
#include "base/narrow.h"
#include <stdlib.h>

/* A branch has at most this share of the work: enough of them for the threads of a large node, few enough that handing
   them out costs nothing. The number depends on the matrix alone. */
static const PetscReal branch_share = 1. / 400.;
/* Right-hand sides, their solutions and work space. */
enum { VECTORS = 12 };

static PetscErrorCode Analyse(EqmFrontal f, const cholmod_sparse *pattern, PetscInt *order)
{
  cholmod_sparse copy = *pattern;

  PetscFunctionBegin;
  CHOLMOD(start)(&f->common);
  f->common.print = 0;
  f->common.supernodal = CHOLMOD_SUPERNODAL;
  f->common.nmethods = 1;
  f->common.method[0].ordering = CHOLMOD_GIVEN;
  f->symbolic = CHOLMOD(analyze_p)(&copy, order, NULL, 0, &f->common);
  f->no_memory = !f->symbolic;
  if (f->no_memory) PetscFunctionReturn(0);
  f->num_unknowns = (PetscInt)f->symbolic->n;
  f->num_fronts = (PetscInt)f->symbolic->nsuper;
  f->column = f->symbolic->super;
  f->row_start = f->symbolic->pi;
  f->value_start = f->symbolic->px;
  f->row = f->symbolic->s;
  PetscFunctionReturn(0);
}

/* Parents, children, and the first front below each. */
static PetscErrorCode MakeTree(EqmFrontal f)
{
  const PetscInt n = f->num_fronts;
  PetscInt *front_of, *next;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(n, &f->parent, n + 2, &f->child_start, n, &f->child, n, &f->first_below));
  PetscCall(PetscMalloc2(f->num_unknowns, &front_of, n + 1, &next));
  for (PetscInt k = 0; k < n; k++) {
    for (PetscInt j = f->column[k]; j < f->column[k + 1]; j++) front_of[j] = k;
  }
  PetscCall(PetscArrayzero(f->child_start, n + 2));
  for (PetscInt k = 0; k < n; k++) {
    f->parent[k] = EqmFrontRest(f, k) > 0 ? front_of[f->row[f->row_start[k] + EqmFrontColumns(f, k)]] : -1;
    f->child_start[(f->parent[k] < 0 ? n : f->parent[k]) + 1]++;
  }
  for (PetscInt k = 0; k <= n; k++) f->child_start[k + 1] += f->child_start[k];
  PetscCall(PetscArraycpy(next, f->child_start, n + 1));
  for (PetscInt k = 0; k < n; k++) {
    f->child[next[f->parent[k] < 0 ? n : f->parent[k]]++] = k;
    f->first_below[k] = f->child_start[k] < f->child_start[k + 1] ? f->first_below[f->child[f->child_start[k]]] : k;
  }
  for (PetscInt k = 0; k < n; k++) { /* a postorder: children end where the next begins */
    PetscInt begin = f->first_below[k];
    for (PetscInt c = f->child_start[k]; c < f->child_start[k + 1]; c++) {
      PetscCheck(f->first_below[f->child[c]] == begin, PETSC_COMM_SELF, PETSC_ERR_PLIB, "supernodes in no postorder");
      begin = f->child[c] + 1;
    }
    PetscCheck(begin == k, PETSC_COMM_SELF, PETSC_ERR_PLIB, "supernodes in no postorder");
  }
  PetscCall(PetscFree2(front_of, next));
  PetscFunctionReturn(0);
}

/* Positions of a front's update rows among the rows of an ancestor: from row `skip` of that on. */
static PetscErrorCode FindRows(EqmFrontal f, PetscInt k, PetscInt above, PetscInt skip, PetscInt *place)
{
  const PetscInt *const rows = f->row + f->row_start[above], most = EqmFrontRows(f, above);
  PetscInt at = skip;

  PetscFunctionBegin;
  for (PetscInt q = f->row_start[k] + EqmFrontColumns(f, k); q < f->row_start[k + 1]; q++) {
    if (f->row[q] < rows[skip]) continue;
    while (at < most && rows[at] < f->row[q]) at++;
    PetscCheck(at < most && rows[at] == f->row[q], PETSC_COMM_SELF, PETSC_ERR_PLIB,
               "a row of a supernode is none of those above it");
    place[q] = at - skip;
  }
  PetscFunctionReturn(0);
}

/* Branches: as much of the tree as has at most a share of the work. */
static PetscErrorCode CutBranches(EqmFrontal f)
{
  PetscReal *work;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(f->num_fronts, &work));
  f->flops = 0.;
  for (PetscInt k = 0; k < f->num_fronts; k++) {
    const PetscReal columns = EqmFrontColumns(f, k), rest = EqmFrontRest(f, k);
    work[k] = columns * (columns * columns / 3. + columns * rest + rest * rest);
    f->flops += work[k];
    for (PetscInt c = f->child_start[k]; c < f->child_start[k + 1]; c++) work[k] += work[f->child[c]];
  }
  const PetscReal most = PetscMax(f->flops * branch_share, EQM_FRONTAL_LEAST_FLOPS);
  for (PetscInt k = 0; k < f->num_fronts; k++) {
    f->is_inside[k] = work[k] <= most;
    f->is_branch[k] = f->is_inside[k] && (f->parent[k] < 0 || work[f->parent[k]] > most);
  }
  PetscCall(PetscFree(work));
  PetscFunctionReturn(0);
}

/* What a branch that ends with front `end` needs. */
static PetscErrorCode MeasureBranch(EqmFrontal f, PetscInt end)
{
  size_t now = 0;

  PetscFunctionBegin;
  for (PetscInt k = f->first_below[end]; k <= end; k++) {
    const size_t rest = (size_t)EqmFrontRest(f, k);
    if (k < end) {
      now += rest * rest;
      f->stack[end] = PetscMax(f->stack[end], now);
    }
    for (PetscInt c = f->child_start[k]; c < f->child_start[k + 1]; c++) {
      const size_t of_child = (size_t)EqmFrontRest(f, f->child[c]);
      now -= of_child * of_child;
    }
    f->most_rows[end] = PetscMax(f->most_rows[end], EqmFrontRows(f, k));
    f->most_panel[end] = PetscMax(f->most_panel[end], EqmFrontPanel(f, k));
    if (EqmFrontRest(f, end) > 0) PetscCall(FindRows(f, k, end, EqmFrontColumns(f, end), f->at_end));
  }
  PetscFunctionReturn(0);
}

/* Who takes what from whom. */
static PetscErrorCode MakePlaces(EqmFrontal f)
{
  const PetscInt n = f->num_fronts;
  PetscInt count = 0;

  PetscFunctionBegin;
  PetscCall(
      PetscMalloc4(f->row_start[n], &f->at_parent, f->row_start[n], &f->at_end, n, &f->is_branch, n, &f->is_inside));
  PetscCall(PetscCalloc6(n, &f->stack, n, &f->most_rows, n, &f->most_panel, n + 1, &f->passed_start, n, &f->panel, n,
                         &f->update));
  PetscCall(CutBranches(f));
  for (PetscInt k = 0; k < n; k++) {
    if (f->parent[k] >= 0) PetscCall(FindRows(f, k, f->parent[k], 0, f->at_parent));
    f->most_rows[k] = EqmFrontRows(f, k);
    f->most_panel[k] = EqmFrontPanel(f, k);
    if (f->is_branch[k]) PetscCall(MeasureBranch(f, k));
    f->passed_start[k] = count;
    if (f->is_branch[k] || !f->is_inside[k]) count += EqmFrontRest(f, k);
  }
  f->passed_start[n] = count;
  PetscFunctionReturn(0);
}

/* To which front and which of its numbers each entry of the matrix goes. */
static PetscErrorCode PlaceEntries(EqmFrontal f, const cholmod_sparse *pattern)
{
  const PetscInt *const start = pattern->p, *const index = pattern->i, n = f->num_fronts;
  PetscInt *front, *target, *front_of;

  PetscFunctionBegin;
  f->num_entries = start[f->num_unknowns];
  PetscCall(PetscMalloc3(n + 2, &f->entry_start, f->num_entries, &f->entry_source, f->num_entries, &f->entry_target));
  PetscCall(PetscMalloc3(f->num_entries, &front, f->num_entries, &target, f->num_unknowns, &front_of));
  PetscCall(PetscArrayzero(f->entry_start, n + 2));
  for (PetscInt k = 0; k < n; k++) {
    for (PetscInt j = f->column[k]; j < f->column[k + 1]; j++) front_of[j] = k;
  }
  for (PetscInt i = 0; i < f->num_unknowns; i++) {
    for (PetscInt q = start[i]; q < start[i + 1]; q++) {
      const PetscInt a = f->position[i], b = f->position[index[q]], row = PetscMax(a, b), column = PetscMin(a, b),
                     k = front_of[column], rows = EqmFrontRows(f, k);
      PetscInt at = row - f->column[k];
      if (at >= EqmFrontColumns(f, k)) PetscCall(PetscFindInt(row, rows, f->row + f->row_start[k], &at));
      PetscCheck(at >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "an entry is in no supernode");
      front[q] = k;
      target[q] = (column - f->column[k]) * rows + at;
      f->entry_start[k + 2]++;
    }
  }
  for (PetscInt k = 0; k < n; k++) f->entry_start[k + 2] += f->entry_start[k + 1];
  for (PetscInt q = 0; q < f->num_entries; q++) {
    const PetscInt to = f->entry_start[front[q] + 1]++;
    f->entry_source[to] = q;
    f->entry_target[to] = target[q];
  }
  PetscCall(PetscFree3(front, target, front_of));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFrontalCreate(const cholmod_sparse *pattern, PetscInt *order, EqmFrontal *out)
{
  EqmFrontal f;

  PetscFunctionBegin;
  PetscCall(PetscNew(&f));
  *out = f;
  PetscCall(Analyse(f, pattern, order));
  if (f->no_memory) PetscFunctionReturn(0);
  PetscCall(PetscMalloc1(f->num_unknowns, &f->position));
  for (PetscInt k = 0; k < f->num_unknowns; k++) f->position[((const PetscInt *)f->symbolic->Perm)[k]] = k;
  PetscCall(MakeTree(f));
  PetscCall(MakePlaces(f));
  PetscCall(PlaceEntries(f, pattern));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFrontalDestroy(EqmFrontal *out)
{
  const EqmFrontal f = *out;

  PetscFunctionBegin;
  if (!f) PetscFunctionReturn(0);
  CHOLMOD(free_factor)(&f->symbolic, &f->common);
  CHOLMOD(finish)(&f->common);
  PetscCall(PetscFree(f->position));
  PetscCall(PetscFree4(f->parent, f->child_start, f->child, f->first_below));
  PetscCall(PetscFree4(f->at_parent, f->at_end, f->is_branch, f->is_inside));
  PetscCall(PetscFree6(f->stack, f->most_rows, f->most_panel, f->passed_start, f->panel, f->update));
  PetscCall(PetscFree3(f->entry_start, f->entry_source, f->entry_target));
  free(f->value);
  PetscCall(PetscFree2(f->columns, f->passed));
  PetscCall(PetscFree(*out));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFrontalKeepSingle(EqmFrontal f)
{
  PetscFunctionBegin;
  f->is_single = PETSC_TRUE;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFrontalKeepBlock(EqmFrontal f, PetscInt n, const PetscInt *at, PetscScalar *block)
{
  PetscFunctionBegin;
  f->num_kept = n;
  f->kept_at = at;
  f->kept_block = block;
  PetscFunctionReturn(0);
}

PetscBool EqmFrontalHasMemory(EqmFrontal f)
{
  return (PetscBool)!f->no_memory;
}

PetscErrorCode EqmFrontalGetPositions(EqmFrontal f, const PetscInt **position)
{
  PetscFunctionBegin;
  *position = f->position;
  PetscFunctionReturn(0);
}

PetscErrorCode EqmFrontalGetCost(EqmFrontal f, EqmEstimate *estimate)
{
  const PetscReal size = f->is_single ? sizeof(float) : sizeof(PetscScalar);
  PetscReal updates = 0., most = 0.;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < f->num_fronts; k++) {
    const PetscReal rest = EqmFrontRest(f, k);
    /* at most those that no front has taken yet */
    updates += rest * rest * (f->is_branch[k] || !f->is_inside[k]) + (PetscReal)f->stack[k];
    most = PetscMax(most, updates + (f->is_single ? (PetscReal)f->most_panel[k] : 0.));
    for (PetscInt c = f->child_start[k]; c < f->child_start[k + 1] && !f->is_inside[k]; c++)
      updates -= PetscSqr((PetscReal)EqmFrontRest(f, f->child[c])) + (PetscReal)f->stack[f->child[c]];
  }
  estimate->nonzeros += f->common.lnz;
  estimate->flops += f->common.fl;
  estimate->bytes_on_rank +=
      size * (PetscReal)f->symbolic->xsize +
      (PetscReal)sizeof(PetscScalar) * (VECTORS * (PetscReal)f->num_unknowns + most) +
      (PetscReal)sizeof(PetscInt) * (3. * f->row_start[f->num_fronts] + 2. * f->num_entries + f->num_unknowns);
  PetscFunctionReturn(0);
}
