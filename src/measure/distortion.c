/* Distortion of a map as the papers measure it; every number from the coordinates alone. */
#include <equimap/energy.h>
#include "mesh/mesh_private.h"
#include <float.h>
#include "geometry/simplex.h"
#include "measure/angles.h"
#include "measure/quantile.h"
#include "measure/weighted.h"
#include "store/map_private.h"

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
      const PetscBool seen = (PetscBool)(EqmHalfDet(x + 3 * v[0], x + 3 * v[1], x + 3 * v[2]) > 0.);
      const PetscReal sign = map->in_space || seen ? 1. : -1.;
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

/* Per vertex the logarithm of what its triangles' area is multiplied by, as shares of image and surface: on the surface
   itself, whatever the density. `a`: image areas, without signs. */
static PetscErrorCode StoreConformalFactor(EqmMap map, EqmMesh mesh, const PetscReal *a)
{
  PetscReal *sum, total[2] = {0., 0.};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * mesh->num_local, &sum));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) {
    for (PetscInt k = 0; k < 3; k++) {
      sum[2 * mesh->cells[3 * c + k]] += PetscAbsReal(a[c]);
      sum[2 * mesh->cells[3 * c + k] + 1] += mesh->cell_measure[c];
    }
    if (c >= mesh->num_owned_cells) continue;
    total[0] += PetscAbsReal(a[c]);
    total[1] += mesh->cell_measure[c];
  }
  PetscCall(MPIU_Allreduce(MPI_IN_PLACE, total, 2, MPIU_REAL, MPIU_SUM, mesh->comm));
  for (PetscInt v = 0; v < mesh->num_owned; v++) { /* a flattened star: finite all the same */
    sum[v] = PetscLogReal(PetscMax(sum[2 * v] / total[0], DBL_MIN)) - PetscLogReal(sum[2 * v + 1] / total[1]);
  }
  PetscCall(EqmMeshVerticesToInput(mesh, map->soup, 1, sum, map->conformal_factor));
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(0);
}

static PetscBool IsFinite(const EqmStatistics *s)
{
  return (PetscBool)!PetscIsInfOrNanReal(s->mean + s->sd + s->min + s->max + s->p25 + s->p50 + s->p75 + s->p95);
}

/* A result whose figures are no numbers must not look like one, whatever spoilt them. Infinite may be
   the mass of the mesh, with densities near the largest double, and quasiconformal distortion: that of a flat image is.
 */
static PetscErrorCode CheckFigures(MPI_Comm comm, PetscInt cell_size, const EqmDistortion *d)
{
  const EqmWeightedRatio *const w = &d->weighted_ratio;
  const EqmStatistics *const q = &d->quasiconformal;
  const PetscReal weighted = w->sd + w->p05 + w->p25 + w->p50 + w->p75 + w->p95 + w->outlier_share + w->cell_sd_without;
  PetscBool finite = (PetscBool)(IsFinite(&d->ratio) && IsFinite(&d->ratio_error));

  PetscFunctionBegin;
  if (PetscIsInfOrNanReal(d->energy + d->image_measure + weighted) || PetscIsNanReal(d->mesh_measure))
    finite = PETSC_FALSE;
  if (cell_size == 3 && (!IsFinite(&d->angle_error) || PetscIsNanReal(q->mean) || PetscIsNanReal(q->p50)))
    finite = PETSC_FALSE;
  PetscCheck(finite, comm, PETSC_ERR_FP, "the figures of the map are not finite");
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
  /* on the sphere the energy is of flat areas without signs, which serve for counting folds only */
  PetscCall(EqmImageSum(mesh, a, &totals));
  map->distortion.folds = totals.folds;
  if (mesh->cell_size == 3 && map->dim == 3) {
    for (PetscInt c = 0; c < mesh->num_local_cells; c++) a[c] = PetscAbsReal(a[c]);
    PetscCall(EqmImageSum(mesh, a, &totals));
  }
  PetscCheck(totals.total > 0. && !PetscIsInfOrNanReal(totals.total + totals.energy), mesh->comm, PETSC_ERR_FP,
             "the figures of the map are not finite: its image measures %g", (double)totals.total);
  map->distortion.energy = totals.energy;
  map->distortion.image_measure = totals.total;
  map->distortion.mesh_measure = mesh->measure;
  map->num_boundary_vertices = mesh->num_boundary_vertices;
  if (mesh->cell_size == 3) PetscCall(StoreConformalFactor(map, mesh, a));
  for (PetscInt c = 0; c < mesh->num_local_cells; c++) a[c] /= mesh->weight[c] * totals.total;
  PetscCall(StoreRatios(map, mesh, a));
  PetscCall(EqmWeightedRatioOf(mesh->comm, n, a, mesh->weight, &map->distortion.weighted_ratio));
  PetscCall(EqmRatioHistogramOf(mesh->comm, n, a, mesh->weight, map->distortion.weighted_ratio.sd,
                                &map->distortion.ratio_histogram));
  PetscCall(PetscArraycpy(sample, a, n));
  PetscCall(EqmStatisticsOf(mesh->comm, n, sample, &map->distortion.ratio));
  for (PetscInt c = 0; c < n; c++) sample[c] = PetscAbsReal(a[c] - 1.);
  PetscCall(EqmStatisticsOf(mesh->comm, n, sample, &map->distortion.ratio_error));
  PetscCall(PetscFree2(a, sample));
  if (mesh->cell_size == 3) PetscCall(EqmMapMeasureAngles(map, mesh, x));
  PetscCall(CheckFigures(mesh->comm, mesh->cell_size, &map->distortion));
  PetscCall(EqmPhaseEnd(mesh->ledger, EQM_PHASE_MEASURE));
  PetscFunctionReturn(0);
}
