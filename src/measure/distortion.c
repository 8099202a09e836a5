/* Distortion of a map as the papers measure it; every number from the coordinates alone. */
#include <equimap/solver.h>
#include "energy/kernel.h"
#include "measure/quantile.h"

/* Angles of a triangle in degrees, corner by corner, from points of `dim` coordinates. */
static void Angles(PetscInt dim, const PetscReal *p[3], PetscReal angle[3])
{
  for (PetscInt a = 0; a < 3; a++) {
    PetscReal u[3] = {0., 0., 0.}, v[3] = {0., 0., 0.};
    for (PetscInt k = 0; k < dim; k++) {
      u[k] = p[(a + 1) % 3][k] - p[a][k];
      v[k] = p[(a + 2) % 3][k] - p[a][k];
    }
    const PetscReal x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    angle[a] =
        PetscAtan2Real(PetscSqrtReal(x * x + y * y + z * z), u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) * 180. / PETSC_PI;
  }
}

/* Ratio of the singular values of the affine map between two triangles, >= 1, from edge lengths and areas: with
   S = sum of cot(mesh angle) * (image edge)^2 / (2 area of the mesh) = s1^2 + s2^2 and P = s1 s2. */
static PetscReal QuasiConformal(PetscInt dim, const PetscReal *p[3], const PetscReal *q[3], PetscReal area_p,
                                PetscReal area_q)
{
  PetscReal energy = 0.;

  for (PetscInt a = 0; a < 3; a++) {
    PetscReal dot = 0., squared = 0.;
    const PetscReal *const p1 = p[(a + 1) % 3], *const p2 = p[(a + 2) % 3], *const q1 = q[(a + 1) % 3],
                           *const q2 = q[(a + 2) % 3];
    for (PetscInt k = 0; k < 3; k++) dot += (p1[k] - p[a][k]) * (p2[k] - p[a][k]);
    for (PetscInt k = 0; k < dim; k++) squared += PetscSqr(q1[k] - q2[k]);
    energy += dot * squared;
  }
  const PetscReal sum = energy / (4. * area_p * area_p), product = area_q / area_p; /* s1^2 + s2^2, s1 s2 */
  const PetscReal half = .5 * sum / product;
  return half > 1. ? half + PetscSqrtReal(half * half - 1.) : 1.;
}

/* Angle differences (3 per owned triangle) and the quasi-conformal distortion. */
static PetscErrorCode MeasureAngles(EqmMap map, EqmMesh mesh, const PetscReal *x)
{
  const PetscInt dim = map->dim, n = mesh->num_owned_cells;
  PetscReal *difference, sum = 0., largest = 0.;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * n, &difference));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *const p[3] = {mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]};
    const PetscReal *const q[3] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
    PetscReal before[3], after[3];
    Angles(3, (const PetscReal **)p, before);
    Angles(dim, (const PetscReal **)q, after);
    for (PetscInt a = 0; a < 3; a++) difference[3 * c + a] = PetscAbsReal(after[a] - before[a]);
  }
  PetscCall(EqmStatisticsOf(mesh->comm, 3 * n, difference, &map->distortion.angle_error));
  PetscCall(PetscFree(difference));
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *p[3] = {mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]};
    const PetscReal *q[3] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
    const PetscReal area = dim == 2 ? PetscAbsReal(EqmArea2(q[0], q[1], q[2])) : EqmArea3(q[0], q[1], q[2]);
    const PetscReal distortion = QuasiConformal(dim, p, q, mesh->shape[c], area);
    sum += distortion;
    largest = PetscMax(largest, distortion);
  }
  PetscCall(MPIU_Allreduce(&sum, &map->distortion.quasiconformal_mean, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  map->distortion.quasiconformal_mean /= PetscMax(1, mesh->num_cells);
  PetscCall(MPIU_Allreduce(&largest, &map->distortion.quasiconformal_max, 1, MPIU_REAL, MPIU_MAX, mesh->comm));
  PetscFunctionReturn(0);
}

/* Signed measure of every local cell; a mirrored map is turned: folds are counted against the majority. */
static PetscErrorCode ImageMeasures(EqmMap map, EqmMesh mesh, const PetscReal *x, PetscReal *a)
{
  PetscReal local = 0., total;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    const PetscInt *const v = mesh->cells + mesh->cell_size * c;
    if (mesh->cell_size == 4) {
      a[c] = EqmVolume(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], x + 3 * v[3]);
    } else if (map->dim == 2) {
      a[c] = EqmArea2(x + 2 * v[0], x + 2 * v[1], x + 2 * v[2]);
    } else { /* on the sphere: the flat area with the sign of det(f_i, f_j, f_k) */
      const PetscReal origin[3] = {0., 0., 0.};
      const PetscReal sign = EqmVolume(origin, x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]) > 0. ? 1. : -1.;
      a[c] = sign * EqmArea3(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]);
    }
    if (c < mesh->num_owned_cells) local += a[c];
  }
  PetscCall(MPIU_Allreduce(&local, &total, 1, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt c = 0; c < mesh->num_local_cells && total < 0.; c++) a[c] = -a[c];
  PetscFunctionReturn(0);
}

/* Ratios to the input numbering: per cell, and per vertex as the weighted mean over its cells. */
static PetscErrorCode StoreRatios(EqmMap map, EqmMesh mesh, const PetscReal *ratio)
{
  PetscReal *sum;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * mesh->num_local, &sum));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt k = 0; k < mesh->cell_size; k++) {
      const PetscInt v = mesh->cells[mesh->cell_size * c + k];
      sum[2 * v] += mesh->weight[c] * ratio[c];
      sum[2 * v + 1] += mesh->weight[c];
    }
  }
  for (PetscInt v = 0; v < mesh->num_owned; v++) sum[v] = sum[2 * v] / sum[2 * v + 1];
  PetscCall(EqmMeshVerticesToInput(mesh, map->soup, 1, sum, map->vertex_ratio));
  PetscCall(PetscFree(sum));
  PetscCall(EqmMeshCellsToInput(mesh, map->soup, 1, ratio, map->cell_ratio));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapMeasure(EqmMap map, EqmMesh mesh, const PetscReal *x)
{
  const PetscInt n = mesh->num_owned_cells;
  PetscReal *a, *sample;
  EqmImageTotals totals;

  PetscFunctionBegin;
  PetscCall(EqmPhaseBegin(mesh->ledger, EQM_PHASE_MEASURE));
  PetscCall(PetscMalloc2(mesh->num_local_cells, &a, n, &sample));
  PetscCall(ImageMeasures(map, mesh, x, a));
  /* on the sphere the energy takes the flat areas without their signs, which only tell the folds */
  PetscCall(EqmImageSum(mesh, a, &totals));
  map->distortion.folds = totals.folds;
  if (mesh->cell_size == 3 && map->dim == 3) {
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) a[c] = PetscAbsReal(a[c]);
    PetscCall(EqmImageSum(mesh, a, &totals));
  }
  map->distortion.energy = totals.energy;
  map->distortion.image_measure = totals.total;
  map->distortion.mesh_measure = mesh->measure;
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) a[c] /= mesh->weight[c] * totals.total;
  PetscCall(StoreRatios(map, mesh, a));
  PetscCall(PetscArraycpy(sample, a, n));
  PetscCall(EqmStatisticsOf(mesh->comm, n, sample, &map->distortion.ratio));
  for (PetscInt c = 0; c < n; c++) sample[c] = PetscAbsReal(a[c] - 1.);
  PetscCall(EqmStatisticsOf(mesh->comm, n, sample, &map->distortion.ratio_error));
  PetscCall(PetscFree2(a, sample));
  if (mesh->cell_size == 3) PetscCall(MeasureAngles(map, mesh, x));
  PetscCall(EqmPhaseEnd(mesh->ledger, EQM_PHASE_MEASURE));
  PetscFunctionReturn(0);
}
