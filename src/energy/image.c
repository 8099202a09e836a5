/* Loops over image simplices. */
#include <equimap/energy.h>
#include "energy/kernel.h"
#include "energy/loops.h"

PetscErrorCode EqmImageMeasure(EqmDomain domain, const EqmPlace *place, PetscReal *a)
{
  const EqmMesh mesh = domain->mesh;
  const PetscReal *const x = place->x;
  const PetscInt *const cells = mesh->cells;

  PetscFunctionBegin;
  PetscCheck(domain->dim == 2 && mesh->cell_size == 3, mesh->comm, PETSC_ERR_SUP, "only planar images of triangles");
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    a[c] = EqmArea2(x + 2 * cells[3 * c], x + 2 * cells[3 * c + 1], x + 2 * cells[3 * c + 2]);
  }
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* Sums of one range of owned cells. */
typedef struct {
  PetscReal total, ratio, squares, weighted, smallest;
  PetscInt64 folds;
} RangeSums;

static PetscErrorCode SumTotal(EqmMesh mesh, const PetscReal *a, PetscReal *total)
{
  PetscReal part[EQM_NUM_RANGES], sum = 0.;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    part[b] = 0.;
    for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++)
      part[b] += a[c];
  }
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum += part[b];
  PetscCall(MPIU_Allreduce(&sum, total, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* Second pass, about the mean: every square is of a difference from one, so nothing cancels near the minimum. */
static void SumRange(EqmMesh mesh, const PetscReal *a, PetscReal total, PetscInt b, RangeSums *sums)
{
  *sums = (RangeSums){.smallest = PETSC_MAX_REAL};
  for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
    const PetscReal w = mesh->weight[c], stretch = a[c] / w, difference = stretch / total - 1.;
    sums->ratio += difference;
    sums->squares += difference * difference;
    sums->weighted += w * difference * difference;
    sums->smallest = PetscMin(sums->smallest, stretch);
    sums->folds += !(a[c] > 0.);
  }
}

PetscErrorCode EqmImageSum(EqmMesh mesh, const PetscReal *a, EqmImageTotals *totals)
{
  RangeSums part[EQM_NUM_RANGES];
  PetscReal sum[3] = {0., 0., 0.}, smallest = PETSC_MAX_REAL;
  PetscInt64 folds = 0;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
  PetscCall(SumTotal(mesh, a, &totals->total));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) SumRange(mesh, a, totals->total, b, &part[b]);
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    sum[0] += part[b].ratio;
    sum[1] += part[b].squares;
    sum[2] += part[b].weighted;
    smallest = PetscMin(smallest, part[b].smallest);
    folds += part[b].folds;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(MPIU_Allreduce(&smallest, &totals->smallest, 1, MPIU_REAL, MPIU_MIN, mesh->comm));
  PetscCall(MPIU_Allreduce(&folds, &totals->folds, 1, MPIU_INT64, MPI_SUM, mesh->comm));
  totals->energy = totals->total * sum[2];
  sum[0] /= mesh->num_cells;
  totals->sd = PetscSqrtReal(PetscMax(0., sum[1] / mesh->num_cells - sum[0] * sum[0]));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* One block: the block's vertices gather from every cell that touches them; each is written by one thread, in one
 * order. */
static void GradientBlock(EqmMesh mesh, const PetscReal *x, const PetscReal *slope, PetscInt b, PetscReal *gradient)
{
  const PetscInt first = mesh->block_vertex[b];
  const size_t length = (size_t)(mesh->block_vertex[b + 1] - first);

  for (size_t k = 0; k < 2 * length; k++) gradient[2 * first + (PetscInt)k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const PetscInt c = mesh->block_cell[q], *const v = mesh->cells + 3 * c;
    PetscReal g[6];
    EqmArea2Gradient(x + 2 * v[0], x + 2 * v[1], x + 2 * v[2], g);
    for (PetscInt corner = 0; corner < 3; corner++) {
      if ((size_t)(v[corner] - first) >= length) continue;
      gradient[2 * v[corner]] += slope[c] * g[2 * corner];
      gradient[2 * v[corner] + 1] += slope[c] * g[2 * corner + 1];
    }
  }
}

PetscErrorCode EqmImageGradient(EqmDomain domain, const EqmPlace *place, const PetscReal *slope, PetscReal *gradient)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) GradientBlock(mesh, place->x, slope, b, gradient);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageDerivatives(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                   const PetscReal *acceleration, PetscReal *first, PetscReal *second)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    PetscReal g[6], rate = 0., bend = 0.;
    EqmArea2Gradient(place->x + 2 * v[0], place->x + 2 * v[1], place->x + 2 * v[2], g);
    for (PetscInt k = 0; k < 6; k++) rate += g[k] * velocity[2 * v[k / 2] + k % 2];
    if (first) first[c] = rate;
    if (!second) continue;
    /* area is quadratic: its second derivative along d is twice the area of the triangle of the d's */
    bend = 2. * EqmArea2(velocity + 2 * v[0], velocity + 2 * v[1], velocity + 2 * v[2]);
    if (acceleration) {
      for (PetscInt k = 0; k < 6; k++) bend += g[k] * acceleration[2 * v[k / 2] + k % 2];
    }
    second[c] = bend;
  }
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}
