/* Incomplete Cholesky factor L L^T of a symmetric positive definite matrix with up to three unknowns per vertex, in
   blocks of a vertex, without fill. Blocks are exact: unknowns that are coordinates in frames may be turned vertex by
   vertex, and the factor turns with them. Between ranks nothing is coupled. */
#include "linalg/blockfactor.h"
#include "mesh/build.h"

enum { B = 3, BB = B * B, MOST_SHIFTS = 40 };

struct _p_EqmBlockFactor {
  EqmMesh mesh;
  EqmUnknowns unknowns;
  PetscInt *start, *column; /* of each row the blocks left of the diagonal, ascending, then the diagonal */
  PetscReal *value;         /* by rows within a block; once factored the diagonal's is the inverse of the factor's */
  PetscReal shift;          /* the diagonal was multiplied by 1 + shift */
};

/* Make the pattern. Not collective. */
PetscErrorCode EqmBlockFactorCreate(EqmMesh mesh, const EqmUnknowns *unknowns, EqmBlockFactor *out)
{
  const PetscInt n = mesh->num_owned;
  EqmBlockFactor f;
  EqmGraph graph;

  PetscFunctionBegin;
  PetscCall(PetscNew(&f));
  f->mesh = mesh;
  f->unknowns = *unknowns;
  PetscCall(EqmGraphOfCells(n, mesh->cell_size, mesh->num_local_cells, mesh->cells, &graph));
  PetscCall(PetscMalloc1(n + 1, &f->start));
  PetscCall(PetscMalloc1(graph.start[n] / 2 + n + 1, &f->column));
  f->start[0] = 0;
  for (PetscInt i = 0; i < n; i++) {
    PetscInt count = 0, *const row = f->column + f->start[i];
    for (PetscInt q = graph.start[i]; q < graph.start[i + 1]; q++) {
      if (graph.neighbor[q] < i) row[count++] = graph.neighbor[q];
    }
    PetscCall(PetscSortInt(count, row));
    row[count++] = i;
    f->start[i + 1] = f->start[i] + count;
  }
  PetscCall(EqmGraphReset(&graph));
  PetscCall(PetscMalloc1((size_t)BB * (size_t)f->start[n], &f->value));
  *out = f;
  PetscFunctionReturn(0);
}

/* Not collective. */
PetscErrorCode EqmBlockFactorDestroy(EqmBlockFactor *factor)
{
  PetscFunctionBegin;
  if (!*factor) PetscFunctionReturn(0);
  PetscCall(PetscFree((*factor)->start));
  PetscCall(PetscFree((*factor)->column));
  PetscCall(PetscFree((*factor)->value));
  PetscCall(PetscFree(*factor));
  PetscFunctionReturn(0);
}

/* Where row i keeps column j <= i, a neighbour. */
static PetscReal *Block(EqmBlockFactor f, PetscInt i, PetscInt j)
{
  PetscInt low = f->start[i], high = f->start[i + 1] - 1;

  while (low < high) {
    const PetscInt middle = (low + high) / 2;
    if (f->column[middle] < j)
      low = middle + 1;
    else
      high = middle;
  }
  return f->value + BB * (size_t)low;
}

/* Add the blocks of a cell's matrix in the rows of the vertices from .. to - 1. */
static void AddCell(EqmBlockFactor f, PetscInt cell, const PetscReal *matrix, PetscInt from, PetscInt to)
{
  const PetscInt corners = f->mesh->cell_size, *const v = f->mesh->cells + corners * cell;
  PetscInt first[5] = {0};

  for (PetscInt a = 0; a < corners; a++) first[a + 1] = first[a] + f->unknowns.count[v[a]];
  for (PetscInt a = 0; a < corners; a++) {
    if (v[a] < from || v[a] >= to) continue;
    for (PetscInt b = 0; b < corners; b++) {
      if (v[b] > v[a]) continue;
      PetscReal *const block = Block(f, v[a], v[b]);
      for (PetscInt i = first[a]; i < first[a + 1]; i++) {
        for (PetscInt j = first[b]; j < first[b + 1]; j++)
          block[B * (i - first[a]) + j - first[b]] += matrix[first[corners] * i + j];
      }
    }
  }
}

/* The sum of the cells' matrices, in a fixed order; unknowns that a vertex has less than three are decoupled. */
static void Assemble(EqmBlockFactor f, EqmCellMatrix cell_matrix, void *context)
{
  const EqmMesh mesh = f->mesh;

#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) {
    const PetscInt from = mesh->block_vertex[b], to = mesh->block_vertex[b + 1];
    PetscReal matrix[EQM_MOST_CELL_UNKNOWNS * EQM_MOST_CELL_UNKNOWNS];
    for (size_t k = BB * (size_t)f->start[from]; k < BB * (size_t)f->start[to]; k++) f->value[k] = 0.;
    for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
      cell_matrix(context, mesh->block_cell[q], matrix);
      AddCell(f, mesh->block_cell[q], matrix, from, to);
    }
    for (PetscInt v = from; v < to; v++) {
      PetscReal *const diagonal = f->value + BB * ((size_t)f->start[v + 1] - 1);
      for (PetscInt k = f->unknowns.count[v]; k < B; k++) diagonal[(B + 1) * k] = 1.;
    }
  }
}

/* c -= a b^T. */
static inline void SubtractProduct(const PetscReal *a, const PetscReal *b, PetscReal *c)
{
  for (int i = 0; i < B; i++) {
    for (int j = 0; j < B; j++) {
      PetscReal sum = 0.;
      for (int k = 0; k < B; k++) sum += a[B * i + k] * b[B * j + k];
      c[B * i + j] -= sum;
    }
  }
}

/* The inverse of the Cholesky factor of a block, in its place; false if the block is not positive definite. */
static PetscBool InvertCholesky(PetscReal *a)
{
  PetscReal l[BB] = {0.};

  for (int j = 0; j < B; j++) {
    for (int i = j; i < B; i++) {
      PetscReal sum = a[B * i + j];
      for (int k = 0; k < j; k++) sum -= l[B * i + k] * l[B * j + k];
      if (i == j && !(sum > PETSC_SQRT_MACHINE_EPSILON * PetscAbsReal(a[B * i + i]))) return PETSC_FALSE;
      l[B * i + j] = i == j ? PetscSqrtReal(sum) : sum / l[(B + 1) * j];
    }
  }
  for (int k = 0; k < BB; k++) a[k] = 0.;
  for (int j = 0; j < B; j++) {
    a[(B + 1) * j] = 1. / l[(B + 1) * j];
    for (int i = j + 1; i < B; i++) {
      PetscReal sum = 0.;
      for (int k = j; k < i; k++) sum -= l[B * i + k] * a[B * k + j];
      a[B * i + j] = sum / l[(B + 1) * i];
    }
  }
  return PETSC_TRUE;
}

/* Row i, those above being done; false if its pivot is not positive definite. */
static PetscBool FactorRow(EqmBlockFactor f, PetscInt i)
{
  const PetscInt last = f->start[i + 1] - 1;
  PetscReal *const diagonal = f->value + BB * (size_t)last;

  for (int k = 0; k < BB; k += B + 1) diagonal[k] *= 1. + f->shift;
  for (PetscInt q = f->start[i]; q < last; q++) {
    const PetscInt k = f->column[q], end = f->start[k + 1] - 1;
    PetscReal *const block = f->value + BB * (size_t)q, product[BB];
    for (PetscInt p = f->start[i], r = f->start[k]; p < q && r < end;) { /* the columns that rows i and k share */
      if (f->column[p] == f->column[r])
        SubtractProduct(f->value + BB * (size_t)p++, f->value + BB * (size_t)r++, block);
      else if (f->column[p] < f->column[r])
        p++;
      else
        r++;
    }
    for (int c = 0; c < BB; c++) product[c] = 0.;
    SubtractProduct(block, f->value + BB * (size_t)end, product); /* minus block L_kk^-T */
    for (int c = 0; c < BB; c++) block[c] = -product[c];
    SubtractProduct(block, block, diagonal);
  }
  return InvertCholesky(diagonal);
}

/* EqmBlockFactorCompute - take new values: the sum of the cells' matrices.

   Not collective: each rank for itself. The incomplete factor of a definite matrix may break down; then the diagonal is
   raised, first by a thousandth, until it does not. */
PetscErrorCode EqmBlockFactorCompute(EqmBlockFactor f, EqmCellMatrix cell_matrix, void *context)
{
  PetscBool done = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(f->mesh->ledger, EQM_EVENT_FACTOR));
  f->shift = 0.;
  for (PetscInt attempt = 0; attempt < MOST_SHIFTS && !done; attempt++) {
    if (attempt > 0) f->shift = PetscMax(2. * f->shift, 1e-3);
    Assemble(f, cell_matrix, context);
    done = PETSC_TRUE;
    for (PetscInt i = 0; i < f->mesh->num_owned && done; i++) done = FactorRow(f, i);
  }
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_MAT_CH_ZRPVT, "no incomplete factor: the matrix is not finite");
  PetscCall(EqmEventEnd(f->mesh->ledger, EQM_EVENT_FACTOR));
  PetscFunctionReturn(0);
}

/* x_i <- L_ii^-1 x_i, or its transpose. */
static inline void ApplyInverse(const PetscReal *inverse, PetscBool transpose, PetscReal *x)
{
  PetscReal y[B];

  for (int i = 0; i < B; i++) {
    y[i] = 0.;
    for (int j = 0; j < B; j++) y[i] += (transpose ? inverse[B * j + i] : inverse[B * i + j]) * x[j];
  }
  for (int i = 0; i < B; i++) x[i] = y[i];
}

static void SolveForward(EqmBlockFactor f, PetscReal *y)
{
  for (PetscInt i = 0; i < f->mesh->num_owned; i++) {
    const PetscInt last = f->start[i + 1] - 1;
    for (PetscInt q = f->start[i]; q < last; q++) {
      const PetscReal *const l = f->value + BB * (size_t)q, *const z = y + B * f->column[q];
      for (int r = 0; r < B; r++) y[B * i + r] -= l[B * r] * z[0] + l[B * r + 1] * z[1] + l[B * r + 2] * z[2];
    }
    ApplyInverse(f->value + BB * (size_t)last, PETSC_FALSE, y + B * i);
  }
}

static void SolveBackward(EqmBlockFactor f, PetscReal *y)
{
  for (PetscInt i = f->mesh->num_owned - 1; i >= 0; i--) {
    const PetscInt last = f->start[i + 1] - 1;
    ApplyInverse(f->value + BB * (size_t)last, PETSC_TRUE, y + B * i);
    for (PetscInt q = f->start[i]; q < last; q++) {
      const PetscReal *const l = f->value + BB * (size_t)q, *const x = y + B * i;
      PetscReal *const z = y + B * f->column[q];
      for (int c = 0; c < B; c++) z[c] -= l[c] * x[0] + l[B + c] * x[1] + l[2 * B + c] * x[2];
    }
  }
}

/* x = (L L^T)^-1 b, of this rank's unknowns; may be the same array. Not collective. */
PetscErrorCode EqmBlockFactorSolve(EqmBlockFactor f, const PetscReal *b, PetscReal *x)
{
  const EqmUnknowns *const u = &f->unknowns;
  PetscReal *y;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(f->mesh->ledger, EQM_EVENT_SOLVE));
  PetscCall(PetscMalloc1(B * f->mesh->num_owned, &y));
  for (PetscInt v = 0; v < f->mesh->num_owned; v++) {
    for (PetscInt k = 0; k < B; k++) y[B * v + k] = k < u->count[v] ? b[u->start[v] - u->first + k] : 0.;
  }
  SolveForward(f, y);
  SolveBackward(f, y);
  for (PetscInt v = 0; v < f->mesh->num_owned; v++) {
    for (PetscInt k = 0; k < u->count[v]; k++) x[u->start[v] - u->first + k] = y[B * v + k];
  }
  PetscCall(PetscFree(y));
  PetscCall(EqmEventEnd(f->mesh->ledger, EQM_EVENT_SOLVE));
  PetscFunctionReturn(0);
}
