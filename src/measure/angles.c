/* What a map does to angles: their differences, the quasi-conformal distortion. */
#include "measure/angles.h"
#include "mesh/mesh_private.h"
#include "geometry/simplex.h"
#include "measure/quantile.h"
#include "store/map_private.h"

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

/* Angle differences (3 per owned triangle): statistics and histogram. */
static PetscErrorCode MeasureDifferences(EqmMap map, EqmMesh mesh, const PetscReal *x)
{
  const PetscInt dim = map->dim, n = mesh->num_owned_cells;
  PetscInt64 *const histogram = map->distortion.angle_histogram;
  PetscReal *difference;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * n, &difference));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *p[3] = {mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]};
    const PetscReal *q[3] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
    PetscReal before[3], after[3];
    Angles(3, p, before);
    Angles(dim, q, after);
    for (PetscInt a = 0; a < 3; a++) difference[3 * c + a] = PetscAbsReal(after[a] - before[a]);
  }
  PetscCall(PetscArrayzero(histogram, EQM_NUM_ANGLE_BINS));
  for (PetscInt k = 0; k < 3 * n; k++) {
    const PetscInt bin = (PetscInt)(difference[k] / 180. * EQM_NUM_ANGLE_BINS);
    histogram[PetscClipInterval(bin, 0, EQM_NUM_ANGLE_BINS - 1)]++;
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, histogram, EQM_NUM_ANGLE_BINS, MPIU_INT64, MPI_SUM, mesh->comm));
  PetscCall(EqmStatisticsOf(mesh->comm, 3 * n, difference, &map->distortion.angle_error));
  PetscCall(PetscFree(difference));
  PetscFunctionReturn(0);
}

static PetscErrorCode MeasureQuasiConformal(EqmMap map, EqmMesh mesh, const PetscReal *x)
{
  const PetscInt dim = map->dim, n = mesh->num_owned_cells;
  PetscReal *distortion;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &distortion));
#pragma omp parallel for schedule(static)
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt *const v = mesh->cells + 3 * c;
    const PetscReal *p[3] = {mesh->position + 3 * v[0], mesh->position + 3 * v[1], mesh->position + 3 * v[2]};
    const PetscReal *q[3] = {x + dim * v[0], x + dim * v[1], x + dim * v[2]};
    const PetscReal area = dim == 2 ? PetscAbsReal(EqmArea2(q[0], q[1], q[2])) : EqmArea3(q[0], q[1], q[2]);
    distortion[c] = QuasiConformal(dim, p, q, mesh->cell_measure[c], area);
  }
  PetscCall(EqmMeshCellsToInput(mesh, map->soup, 1, distortion, map->quasi_conformal));
  PetscCall(EqmStatisticsOf(mesh->comm, n, distortion, &map->distortion.quasiconformal));
  PetscCall(PetscFree(distortion));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmMapMeasureAngles(EqmMap map, EqmMesh mesh, const PetscReal *x)
{
  PetscFunctionBegin;
  PetscCall(MeasureDifferences(map, mesh, x));
  PetscCall(MeasureQuasiConformal(map, mesh, x));
  PetscFunctionReturn(0);
}
