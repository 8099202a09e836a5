/* Laplacians by edge weights per cell: applied without a matrix, assembled in linalg. */
#include <equimap/energy.h>
#include "energy/kernel.h"
#include "energy/loops.h"

static inline PetscReal Dot(PetscInt dim, const PetscReal *p, const PetscReal *q, const PetscReal *r)
{
  PetscReal sum = 0.; /* (q - p) . (r - p) */
  for (PetscInt k = 0; k < dim; k++) sum += (q[k] - p[k]) * (r[k] - p[k]);
  return sum;
}

PetscErrorCode EqmLaplacianWeights(EqmDomain domain, EqmLaplacianKind kind, const EqmPlace *place, PetscReal *weights)
{
  const EqmMesh mesh = domain->mesh;
  const PetscBool of_image = (PetscBool)(kind == EQM_LAPLACIAN_STRETCH);
  const PetscInt dim = of_image ? domain->dim : 3;
  const PetscReal *const x = of_image ? place->x : mesh->position;

  PetscFunctionBegin;
  PetscCall(EqmEventBegin(mesh->ledger, EQM_EVENT_KERNEL));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    for (PetscInt a = 0; a < 3; a++) {
      const PetscReal dot = Dot(dim, x + dim * v[a], x + dim * v[(a + 1) % 3], x + dim * v[(a + 2) % 3]);
      /* cot = dot / (2 area); 000 (2d): cot |f(t)| / (2 |t|) = dot / (4 |t|), smooth through image area zero */
      if (kind == EQM_LAPLACIAN_UNIFORM)
        weights[3 * c + a] = .5;
      else if (kind == EQM_LAPLACIAN_COTANGENT)
        weights[3 * c + a] = .25 * dot / mesh->shape[c];
      else
        weights[3 * c + a] = .25 * dot / mesh->weight[c];
    }
  }
  PetscCall(EqmEventEnd(mesh->ledger, EQM_EVENT_KERNEL));
  PetscFunctionReturn(0);
}

/* One block of rows: y_i = sum of w_ij (x_i - x_j), differences first. */
static void ApplyBlock(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x, PetscInt b,
                       PetscReal *y)
{
  const PetscInt first = mesh->block_vertex[b];
  const size_t length = (size_t)(mesh->block_vertex[b + 1] - first);

  for (PetscInt k = width * first; k < width * mesh->block_vertex[b + 1]; k++) y[k] = 0.;
  for (PetscInt q = mesh->block_start[b]; q < mesh->block_start[b + 1]; q++) {
    const PetscInt c = mesh->block_cell[q], *const v = mesh->cells + 3 * c;
    for (PetscInt a = 0; a < 3; a++) {
      if ((size_t)(v[a] - first) >= length) continue;
      const PetscInt i = v[a], j = v[(a + 1) % 3], l = v[(a + 2) % 3];
      const PetscReal w_ij = weights[3 * c + (a + 2) % 3], w_il = weights[3 * c + (a + 1) % 3];
      for (PetscInt k = 0; k < width; k++) {
        y[width * i + k] += w_ij * (x[width * i + k] - x[width * j + k]) + w_il * (x[width * i + k] - x[width * l + k]);
      }
    }
  }
}

PetscErrorCode EqmLaplacianApply(EqmMesh mesh, const PetscReal *weights, PetscInt width, const PetscReal *x,
                                 PetscReal *y)
{
  PetscFunctionBegin;
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
