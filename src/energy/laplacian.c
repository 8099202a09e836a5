/* Laplacians by edge weights per cell: applied without a matrix, assembled in linalg. */
#include <equimap/energy.h>
#include "domain/domain_private.h"
#include "geometry/simplex.h"
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

/* The same for tetrahedra: scale times minus the dot products of the volume's gradients at the ends of each edge over
   `measure`. With G = dV/dx, L = sum of G G^T over |V| is the Dirichlet energy's, and 2/3 sum of G G^T over |t| is L_V:
   003 (3c) with the missing edge length, and without cotangents, which are singular where an image is flat. */
static void VolumeWeights(EqmMesh mesh, PetscReal scale, const PetscReal *x, const PetscReal *measure, PetscInt first,
                          PetscInt last, PetscReal *weights)
{
  for (PetscInt c = first; c < last; c++) {
    const PetscInt *const v = mesh->cells + 4 * c;
    const PetscReal *const p[] = {x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]};
    PetscReal g[12];
    EqmVolumeGradient(p, g);
    for (PetscInt e = 0; e < 6; e++) {
      PetscInt i, j;
      EqmCellEdge(4, e, &i, &j);
      weights[6 * c + e] = -scale / measure[c] * EqmDot3(g + 3 * i, g + 3 * j);
    }
  }
}

/* Half the cotangents of triangles that are known by the lengths of their edges. */
static void WeightsOfLengths(const PetscReal *length, const PetscReal *area, PetscInt first, PetscInt last,
                             PetscReal *weights)
{
  for (PetscInt c = first; c < last; c++) {
    for (PetscInt k = 0; k < 3; k++) {
      const PetscReal *const l = length + 3 * c;
      weights[3 * c + k] = .125 * (PetscSqr(l[(k + 1) % 3]) + PetscSqr(l[(k + 2) % 3]) - PetscSqr(l[k])) / area[c];
    }
  }
}

/* cot = dot / (2 area); 000 (2d): cot |f(t)| / (2 |t|) = dot / (4 |t|), smooth through image area zero. */
static void WeightsOfRange(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place, PetscInt b,
                           PetscReal *weights)
{
  const EqmMesh mesh = domain->mesh;
  const PetscInt edges = EqmCellNumEdges(mesh->cell_size);
  const PetscInt first = EqmRangeStart(mesh->num_local_cells, b), last = EqmRangeStart(mesh->num_local_cells, b + 1);

  if (kind == EQM_LAPLACIAN_UNIFORM) {
    for (PetscInt k = edges * first; k < edges * last; k++) weights[k] = .5;
  } else if (mesh->cell_size == 4) {
    if (kind == EQM_LAPLACIAN_COTANGENT)
      VolumeWeights(mesh, 1., mesh->position, mesh->cell_measure, first, last, weights);
    else
      VolumeWeights(mesh, 2. / 3., place->x, mesh->weight, first, last, weights);
  } else if (kind == EQM_LAPLACIAN_COTANGENT && mesh->edge_length) {
    WeightsOfLengths(mesh->edge_length, mesh->cell_measure, first, last, weights);
  } else if (kind == EQM_LAPLACIAN_COTANGENT) {
    DotWeights(3, mesh->cells, mesh->position, mesh->cell_measure, first, last, weights);
  } else if (domain->dim == 2) {
    DotWeights(2, mesh->cells, place->x, mesh->weight, first, last, weights);
  } else {
    DotWeights(3, mesh->cells, place->x, mesh->weight, first, last, weights);
  }
}

PetscErrorCode EqmLaplacianWeights(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place, PetscReal *weights)
{
  const EqmMesh mesh = domain->mesh;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt b = 0; b < EQM_NUM_RANGES; b++) WeightsOfRange(domain, kind, place, b, weights);
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* One block of rows: y_i = sum of w_ij (x_i - x_j), differences first; compiled for each kind of cell and width. */
static inline __attribute__((always_inline)) void ApplyWidth(PetscInt corners, PetscInt width, EqmMesh mesh,
                                                             const PetscReal *weights, const PetscReal *x, PetscInt b,
                                                             PetscReal *y)
{
  const size_t first = (size_t)mesh->block_vertex[b], length = (size_t)mesh->block_vertex[b + 1] - first;
  const size_t stride = (size_t)width;
  const PetscInt edges = EqmCellNumEdges(corners);

  for (size_t k = stride * first; k < stride * (first + length); k++) y[k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const PetscInt c = mesh->block_cell[q], *const v = mesh->cells + corners * c;
    PetscReal sum[4][3] = {{0.}};
    for (PetscInt e = 0; e < edges; e++) {
      PetscInt i, j;
      EqmCellEdge(corners, e, &i, &j);
      for (size_t k = 0; k < stride; k++) {
        const PetscReal flow = weights[edges * c + e] * (x[stride * (size_t)v[i] + k] - x[stride * (size_t)v[j] + k]);
        sum[i][k] += flow;
        sum[j][k] -= flow;
      }
    }
    for (PetscInt a = 0; a < corners; a++) {
      for (size_t k = 0; k < stride && (size_t)v[a] - first < length; k++) y[stride * (size_t)v[a] + k] += sum[a][k];
    }
  }
}

static void ApplyBlock(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x, PetscInt b,
                       PetscReal *y)
{
  if (mesh->cell_size == 4)
    ApplyWidth(4, width, mesh, weights, x, b, y);
  else if (width == 1)
    ApplyWidth(3, 1, mesh, weights, x, b, y);
  else if (width == 2)
    ApplyWidth(3, 2, mesh, weights, x, b, y);
  else
    ApplyWidth(3, 3, mesh, weights, x, b, y);
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
  const PetscInt edges = EqmCellNumEdges(mesh->cell_size);
  PetscReal sum = 0.;

  for (PetscInt c = EqmRangeStart(mesh->num_owned_cells, b); c < EqmRangeStart(mesh->num_owned_cells, b + 1); c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;
    for (PetscInt e = 0; e < edges; e++) {
      PetscInt i, j;
      EqmCellEdge(mesh->cell_size, e, &i, &j);
      for (PetscInt k = 0; k < width; k++)
        sum += weights[edges * c + e] * PetscSqr(x[width * v[i] + k] - x[width * v[j] + k]);
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
