/* Loops over image simplices. */
#include <equimap/energy.h>
#include "domain/domain_private.h"
#include "geometry/simplex.h"
#include "energy/loops.h"

/* Run a loop compiled for its measure. Use it inside the parallel region: the compiler outlines the region before it
   inlines, so that a constant from outside is a variable there. */
#define FOR_MEASURE(kind, loop, ...)                                                                                   \
  do {                                                                                                                 \
    if ((kind) == EQM_MEASURE_AREA2)                                                                                   \
      loop(EQM_MEASURE_AREA2, __VA_ARGS__);                                                                            \
    else if ((kind) == EQM_MEASURE_AREA3)                                                                              \
      loop(EQM_MEASURE_AREA3, __VA_ARGS__);                                                                            \
    else if ((kind) == EQM_MEASURE_VOLUME)                                                                             \
      loop(EQM_MEASURE_VOLUME, __VA_ARGS__);                                                                           \
    else if ((kind) == EQM_MEASURE_SOLID_ANGLE)                                                                        \
      loop(EQM_MEASURE_SOLID_ANGLE, __VA_ARGS__);                                                                      \
    else                                                                                                               \
      loop(EQM_MEASURE_HALF_DET, __VA_ARGS__);                                                                         \
  } while (0)

/* Pointers to the corners of a cell, in an array with `dim` reals per vertex. */
static inline void Corners(PetscInt num_corners, PetscInt dim, const PetscInt *vertex, const PetscReal *x,
                           const PetscReal *p[EQM_MAX_CORNERS])
{
  for (PetscInt a = 0; a < num_corners; a++) p[a] = x + dim * vertex[a];
}

static inline __attribute__((always_inline)) void MeasureRange(EqmMeasureKind kind, EqmMesh mesh, PetscInt b,
                                                               const PetscReal *x, PetscReal *a)
{
  const PetscInt dim = EqmMeasureDim(kind), num_corners = EqmMeasureCorners(kind);
  const PetscInt last = EqmRangeStart(mesh->num_local_cells, b + 1);

  for (PetscInt c = EqmRangeStart(mesh->num_local_cells, b); c < last; c++) {
    const PetscReal *p[EQM_MAX_CORNERS];
    Corners(num_corners, dim, mesh->cells + num_corners * c, x, p);
    a[c] = EqmMeasureValue(kind, p);
  }
}

PetscErrorCode EqmImageMeasureOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place, PetscReal *a)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) FOR_MEASURE(kind, MeasureRange, mesh, b, place->x, a);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageMeasure(EqmDomain domain, const EqmPlace *place, PetscReal *a)
{
  PetscFunctionBegin;
  PetscCall(EqmImageMeasureOf(domain, domain->measure, place, a));
  PetscFunctionReturn(0);
}

/* Sums of one range of owned cells. Each runs in LANES interleaved parts, for one addition must wait for the one
   before; the parts are added in a fixed order. */
enum { LANES = 4 };
typedef struct {
  PetscReal total, ratio, squares, weighted, smallest;
  PetscInt64 folds;
} RangeSums;

static PetscReal TotalOfRange(const PetscReal *a, PetscInt first, PetscInt last)
{
  PetscReal part[LANES] = {0.};
  PetscInt c = first;

  for (; c + LANES <= last; c += LANES) {
    for (PetscInt l = 0; l < LANES; l++) part[l] += a[c + l];
  }
  for (; c < last; c++) part[0] += a[c];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

static PetscErrorCode SumTotal(EqmMesh mesh, const PetscReal *a, PetscReal *total)
{
  PetscReal part[EQM_NUM_RANGES], sum = 0.;
  const PetscInt n = mesh->num_owned_cells;

  PetscFunctionBegin;
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) part[b] = TotalOfRange(a, EqmRangeStart(n, b), EqmRangeStart(n, b + 1));
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum += part[b];
  PetscCall(MPIU_Allreduce(&sum, total, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscFunctionReturn(0);
}

/* `count` <= LANES cells from c on, one to each part. */
static inline void SumLanes(const PetscReal *w, const PetscReal *a, PetscReal total, PetscInt count,
                            PetscReal part[4][LANES], PetscInt64 folds[LANES])
{
  for (PetscInt l = 0; l < count; l++) {
    const PetscReal ratio = a[l] / (w[l] * total), difference = ratio - 1.;
    part[0][l] += difference;
    part[1][l] += difference * difference;
    part[2][l] += w[l] * (difference * difference);
    part[3][l] = ratio < part[3][l] ? ratio : part[3][l];
    folds[l] += !(a[l] > 0.);
  }
}

/* Second pass, about the mean: every square is of a difference from one, so nothing cancels near the minimum. */
static void SumRange(EqmMesh mesh, const PetscReal *a, PetscReal total, PetscInt b, RangeSums *sums)
{
  const PetscInt last = EqmRangeStart(mesh->num_owned_cells, b + 1);
  PetscReal part[4][LANES] = {{0.}, {0.}, {0.}, {PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL}};
  PetscInt64 folds[LANES] = {0};

  for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < last; c += LANES) {
    if (c + LANES <= last)
      SumLanes(mesh->weight + c, a + c, total, LANES, part, folds);
    else
      SumLanes(mesh->weight + c, a + c, total, last - c, part, folds);
  }
  *sums = (RangeSums){.ratio = (part[0][0] + part[0][1]) + (part[0][2] + part[0][3]),
                      .squares = (part[1][0] + part[1][1]) + (part[1][2] + part[1][3]),
                      .weighted = (part[2][0] + part[2][1]) + (part[2][2] + part[2][3]),
                      .smallest = total * PetscMin(PetscMin(part[3][0], part[3][1]), PetscMin(part[3][2], part[3][3])),
                      .folds = folds[0] + folds[1] + folds[2] + folds[3]};
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
   order. */
static inline __attribute__((always_inline)) void GradientBlock(EqmMeasureKind kind, EqmMesh mesh, const PetscReal *x,
                                                                const PetscReal *slope, PetscInt b, PetscReal *gradient)
{
  const PetscInt dim = EqmMeasureDim(kind), num_corners = EqmMeasureCorners(kind), first = mesh->block_vertex[b];
  const size_t length = (size_t)(mesh->block_vertex[b + 1] - first);

  for (size_t k = 0; k < (size_t)dim * length; k++) gradient[(size_t)(dim * first) + k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const PetscInt c = mesh->block_cell[q], *const v = mesh->cells + num_corners * c;
    const PetscReal *p[EQM_MAX_CORNERS];
    PetscReal g[12];
    Corners(num_corners, dim, v, x, p);
    EqmMeasureGradient(kind, p, g);
    for (PetscInt corner = 0; corner < num_corners; corner++) {
      if ((size_t)(v[corner] - first) >= length) continue;
      for (PetscInt k = 0; k < dim; k++) gradient[dim * v[corner] + k] += slope[c] * g[dim * corner + k];
    }
  }
}

/* The same in the plane: a corner's gradient is half the opposite edge turned by a right angle; the sum of the edges is
   turned, not each. */
static void PlaneGradientBlock(EqmMesh mesh, const PetscReal *x, const PetscReal *slope, PetscInt b,
                               PetscReal *gradient)
{
  const EqmPoint2 *const p = (const EqmPoint2 *)x;
  EqmPoint2 *const sum = (EqmPoint2 *)gradient;
  const size_t first = (size_t)mesh->block_vertex[b], length = (size_t)mesh->block_vertex[b + 1] - first;

  for (size_t v = first; v < first + length; v++) sum[v] = (EqmPoint2){0., 0.};
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const size_t c = (size_t)mesh->block_cell[q];
    const size_t i = (size_t)mesh->cells[3 * c], j = (size_t)mesh->cells[3 * c + 1], k = (size_t)mesh->cells[3 * c + 2];
    const PetscReal half = .5 * slope[c];
    const EqmPoint2 pi = p[i], pj = p[j], pk = p[k];
    if (i - first < length) sum[i] += half * (pj - pk);
    if (j - first < length) sum[j] += half * (pk - pi);
    if (k - first < length) sum[k] += half * (pi - pj);
  }
  for (size_t v = first; v < first + length; v++) sum[v] = (EqmPoint2){sum[v][1], -sum[v][0]};
}

PetscErrorCode EqmImageGradientOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place, const PetscReal *slope,
                                  PetscReal *gradient)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) {
    if (kind == EQM_MEASURE_AREA2)
      PlaneGradientBlock(mesh, place->x, slope, b, gradient);
    else
      FOR_MEASURE(kind, GradientBlock, mesh, place->x, slope, b, gradient);
  }
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmImageGradient(EqmDomain domain, const EqmPlace *place, const PetscReal *slope, PetscReal *gradient)
{
  PetscFunctionBegin;
  PetscCall(EqmImageGradientOf(domain, domain->measure, place, slope, gradient));
  PetscFunctionReturn(0);
}

static inline __attribute__((always_inline)) void DerivativesRange(EqmMeasureKind kind, EqmMesh mesh, PetscInt b,
                                                                   const PetscReal *x, const PetscReal *velocity,
                                                                   const PetscReal *acceleration, PetscReal *first,
                                                                   PetscReal *second)
{
  const PetscInt dim = EqmMeasureDim(kind), num_corners = EqmMeasureCorners(kind);
  const PetscInt last = EqmRangeStart(mesh->num_local_cells, b + 1);

  for (PetscInt c = EqmRangeStart(mesh->num_local_cells, b); c < last; c++) {
    const PetscInt *const v = mesh->cells + num_corners * c;
    const PetscReal *p[EQM_MAX_CORNERS], *d[EQM_MAX_CORNERS];
    PetscReal g[12], rate = 0., second_derivative;
    Corners(num_corners, dim, v, x, p);
    Corners(num_corners, dim, v, velocity, d);
    EqmMeasureGradient(kind, p, g);
    for (PetscInt a = 0; a < num_corners; a++) {
      for (PetscInt k = 0; k < dim; k++) rate += g[dim * a + k] * velocity[dim * v[a] + k];
    }
    if (first) first[c] = rate;
    if (!second) continue;
    second_derivative = EqmMeasureSecondDerivative(kind, p, d);
    for (PetscInt a = 0; a < num_corners && acceleration; a++) {
      for (PetscInt k = 0; k < dim; k++) second_derivative += g[dim * a + k] * acceleration[dim * v[a] + k];
    }
    second[c] = second_derivative;
  }
}

PetscErrorCode EqmImageDerivativesOf(EqmDomain domain, EqmMeasureKind kind, const EqmPlace *place,
                                     const PetscReal *velocity, const PetscReal *acceleration, PetscReal *first,
                                     PetscReal *second)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++)
    FOR_MEASURE(kind, DerivativesRange, mesh, b, place->x, velocity, acceleration, first, second);
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
