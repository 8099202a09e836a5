/* Laplacians by edge weights per cell: applied without a matrix, assembled in linalg. */
#include <equimap/energy.h>
#include "energy/kernel.h"
#include "energy/loops.h"

/* Weights of the cells first .. last-1: scale times the dot products of the edges at each corner over `measure`;
   compiled for each dimension. */
static inline __attribute__((always_inline)) void DotWeights(PetscInt dim, const PetscInt *cells, const PetscReal *x,
                                                             const PetscReal *measure, PetscInt first, PetscInt last,
                                                             PetscReal *weights)
{
  for (PetscInt c = first; c < last; c++) {
    const PetscReal *const p = x + dim * cells[3 * c], *const q = x + dim * cells[3 * c + 1],
                           *const r = x + dim * cells[3 * c + 2];
    const PetscReal factor = -.25 / measure[c];
    PetscReal dot[3] = {0., 0., 0.};
    for (PetscInt k = 0; k < dim; k++) {
      const PetscReal pq = q[k] - p[k], qr = r[k] - q[k], rp = p[k] - r[k];
      dot[0] += rp * pq;
      dot[1] += pq * qr;
      dot[2] += qr * rp;
    }
    for (PetscInt a = 0; a < 3; a++) weights[3 * c + a] = factor * dot[a];
  }
}

PetscErrorCode EqmLaplacianWeights(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place, PetscReal *weights)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) {
    const PetscInt first = EqmRangeStart(mesh->num_local_cells, b), last = EqmRangeStart(mesh->num_local_cells, b + 1);
    /* cot = dot / (2 area); 000 (2d): cot |f(t)| / (2 |t|) = dot / (4 |t|), smooth through image area zero */
    if (kind == EQM_LAPLACIAN_COTANGENT)
      DotWeights(3, mesh->cells, mesh->position, mesh->shape, first, last, weights);
    else if (kind == EQM_LAPLACIAN_STRETCH && domain->dim == 2)
      DotWeights(2, mesh->cells, place->x, mesh->weight, first, last, weights);
    else if (kind == EQM_LAPLACIAN_STRETCH)
      DotWeights(3, mesh->cells, place->x, mesh->weight, first, last, weights);
    else
      for (PetscInt k = 3 * first; k < 3 * last; k++) weights[k] = .5;
  }
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* One block of rows: y_i = sum of w_ij (x_i - x_j), differences first; compiled for each width. */
static inline __attribute__((always_inline)) void ApplyWidth(PetscInt width, EqmMesh mesh, const PetscReal *weights,
                                                             const PetscReal *x, PetscInt b, PetscReal *y)
{
  const size_t first = (size_t)mesh->block_vertex[b], length = (size_t)mesh->block_vertex[b + 1] - first;
  const size_t stride = (size_t)width;

  for (size_t k = stride * first; k < stride * (first + length); k++) y[k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const size_t c = (size_t)mesh->block_cell[q];
    const size_t i = (size_t)mesh->cells[3 * c], j = (size_t)mesh->cells[3 * c + 1], l = (size_t)mesh->cells[3 * c + 2];
    const PetscReal *const w = weights + 3 * c;
    PetscReal jl[3], li[3], ij[3];
    for (size_t k = 0; k < stride; k++) {
      jl[k] = w[0] * (x[stride * j + k] - x[stride * l + k]);
      li[k] = w[1] * (x[stride * l + k] - x[stride * i + k]);
      ij[k] = w[2] * (x[stride * i + k] - x[stride * j + k]);
    }
    for (size_t k = 0; k < stride && i - first < length; k++) y[stride * i + k] += ij[k] - li[k];
    for (size_t k = 0; k < stride && j - first < length; k++) y[stride * j + k] += jl[k] - ij[k];
    for (size_t k = 0; k < stride && l - first < length; k++) y[stride * l + k] += li[k] - jl[k];
  }
}

static void ApplyBlock(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x, PetscInt b,
                       PetscReal *y)
{
  if (width == 1)
    ApplyWidth(1, mesh, weights, x, b, y);
  else if (width == 2)
    ApplyWidth(2, mesh, weights, x, b, y);
  else
    ApplyWidth(3, mesh, weights, x, b, y);
}

PetscErrorCode EqmLaplacianApply(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x,
                                 PetscReal *y)
{
  PetscFunctionBegin;
  PetscCheck(width >= 1 && width <= 3, mesh->comm, PETSC_ERR_ARG_OUTOFRANGE, "width %" PetscInt_FMT, width);
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < mesh->num_blocks; b++) ApplyBlock(mesh, weights, width, x, b, y);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* 1/2 sum over edges and cells of w (x_i - x_j)^2 in one range. */
static PetscReal EnergyRange(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x, PetscInt b)
{
  PetscReal sum = 0.;

  for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    for (PetscInt a = 0; a < 3; a++) {
      for (PetscInt k = 0; k < width; k++) {
        sum += weights[3 * c + a] * PetscSqr(x[width * v[(a + 1) % 3] + k] - x[width * v[(a + 2) % 3] + k]);
      }
    }
  }
  return .5 * sum;
}

PetscErrorCode EqmLaplacianEnergy(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x,
                                  PetscReal *energy)
{
  PetscReal part[EQM_NUM_RANGES], sum = 0.;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) part[b] = EnergyRange(mesh, weights, width, x, b);
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) sum += part[b];
  PetscCall(MPIU_Allreduce(&sum, energy, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}
