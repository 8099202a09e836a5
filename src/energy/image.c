/* Loops over image simplices. */
#include <equimap/energy.h>
#include "energy/kernel.h"
#include "energy/loops.h"

/* Run a loop compiled for its measure. */
#define FOR_MEASURE(kind, loop, ...)                                                                                   \
  do {                                                                                                                 \
    if ((kind) == EQM_MEASURE_AREA2)                                                                                   \
      loop(EQM_MEASURE_AREA2, __VA_ARGS__);                                                                            \
    else if ((kind) == EQM_MEASURE_AREA3)                                                                              \
      loop(EQM_MEASURE_AREA3, __VA_ARGS__);                                                                            \
    else                                                                                                               \
      loop(EQM_MEASURE_HALF_DET, __VA_ARGS__);                                                                         \
  } while (0)

static inline __attribute__((always_inline)) void MeasureLoop(EqmMeasureKind kind, EqmMesh mesh, const PetscReal *x,
                                                              PetscReal *a)
{
  const PetscInt dim = EqmMeasureDim(kind), *const cells = mesh->cells;

#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    a[c] = EqmMeasureValue(kind, x + dim * cells[3 * c], x + dim * cells[3 * c + 1], x + dim * cells[3 * c + 2]);
  }
}

PetscErrorCode EqmImageMeasureOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place, PetscReal *a)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
  FOR_MEASURE(kind, MeasureLoop, mesh, place->x, a);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageMeasure(EqmDomain domain, const EqmPlace *place, PetscReal *a)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(domain, domain->measure, place, a));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageFolds(EqmDomain domain, const EqmPlace *place, PetscReal *scratch, PetscInt64 *folds)
{
  const EqmMesh mesh = domain->mesh;
  PetscInt64 count = 0;

  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(domain, domain->curved_image ? EQM_MEASURE_HALF_DET : domain->measure, place, scratch));
  for (PetscInt c = 0; c < mesh->num_owned_cells; c++) count += !(scratch[c] > 0.);
  PetscCall(MPIU_Allreduce(&count, folds, 1, MPIU_INT64, MPI_SUM, mesh->comm));
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
static inline __attribute__((always_inline)) void GradientBlock(EqmMeasureKind kind, EqmMesh mesh, const PetscReal *x,
                                                                const PetscReal *slope, PetscInt b, PetscReal *gradient)
{
  const PetscInt dim = EqmMeasureDim(kind), first = mesh->block_vertex[b];
  const size_t length = (size_t)(mesh->block_vertex[b + 1] - first);

  for (size_t k = 0; k < (size_t)dim * length; k++) gradient[(size_t)(dim * first) + k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const PetscInt c = mesh->block_cell[q], *const v = mesh->cells + 3 * c;
    PetscReal g[9];
    EqmMeasureGradient(kind, x + dim * v[0], x + dim * v[1], x + dim * v[2], g);
    for (PetscInt corner = 0; corner < 3; corner++) {
      if ((size_t)(v[corner] - first) >= length) continue;
      for (PetscInt k = 0; k < dim; k++) gradient[dim * v[corner] + k] += slope[c] * g[dim * corner + k];
    }
  }
}

static inline __attribute__((always_inline)) void GradientLoop(EqmMeasureKind kind, EqmMesh mesh, const PetscReal *x,
                                                               const PetscReal *slope, PetscReal *gradient)
{
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) GradientBlock(kind, mesh, x, slope, b, gradient);
}

PetscErrorCode EqmImageGradientOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place, const PetscReal *slope,
                                  PetscReal *gradient)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
  FOR_MEASURE(kind, GradientLoop, mesh, place->x, slope, gradient);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageGradient(EqmDomain domain, const EqmPlace *place, const PetscReal *slope, PetscReal *gradient)
{
  PetscFunctionBegin;
  PetscCall(EqmImageGradientOf(domain, domain->measure, place, slope, gradient));
  PetscFunctionReturn(0);
}

static inline __attribute__((always_inline)) void DerivativesLoop(EqmMeasureKind kind, EqmMesh mesh, const PetscReal *x,
                                                                  const PetscReal *velocity,
                                                                  const PetscReal *acceleration, PetscReal *first,
                                                                  PetscReal *second)
{
  const PetscInt dim = EqmMeasureDim(kind);

#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *const p = x + dim * v[0], *const q = x + dim * v[1], *const r = x + dim * v[2];
    PetscReal g[9], rate = 0., bend;
    EqmMeasureGradient(kind, p, q, r, g);
    for (PetscInt a = 0; a < 3; a++) {
      for (PetscInt k = 0; k < dim; k++) rate += g[dim * a + k] * velocity[dim * v[a] + k];
    }
    if (first) first[c] = rate;
    if (!second) continue;
    bend = EqmMeasureBend(kind, p, q, r, velocity + dim * v[0], velocity + dim * v[1], velocity + dim * v[2]);
    for (PetscInt a = 0; a < 3 && acceleration; a++) {
      for (PetscInt k = 0; k < dim; k++) bend += g[dim * a + k] * acceleration[dim * v[a] + k];
    }
    second[c] = bend;
  }
}

PetscErrorCode EqmImageDerivativesOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place,
                                     const PetscReal *velocity, const PetscReal *acceleration, PetscReal *first,
                                     PetscReal *second)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
  FOR_MEASURE(kind, DerivativesLoop, mesh, place->x, velocity, acceleration, first, second);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageDerivatives(EqmDomain domain, const EqmPlace *place, const PetscReal *velocity,
                                   const PetscReal *acceleration, PetscReal *first, PetscReal *second)
{
  PetscFunctionBegin;
  PetscCall(EqmImageDerivativesOf(domain, domain->measure, place, velocity, acceleration, first, second));
  PetscFunctionReturn(0);
}
